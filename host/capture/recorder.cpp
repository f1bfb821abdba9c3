#include "capture/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>

#include "capture/replay.hpp"
#include "common/error.hpp"
#include "wavefront/records.hpp"

namespace raymill::capture {

using profile::Stage;

namespace {

/// The whole text as a number that is not negative, or nothing.
template <class Number>
std::optional<Number> number(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
    return value;
}

std::vector<std::uint32_t> segment_counts(const Device& device, const WaveView& view) {
    const std::size_t segments = std::size_t{Stages::chunks(view.rays.count)} * view.slots.count;
    return view.shadow_rays.counts.read(device, 0, segments);
}

std::uint64_t shadow_ray_count(const Device& device, const WaveView& view) {
    const auto counts = segment_counts(device, view);
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::vector<ShadowRay> packed_shadow_rays(const Device& device, const WaveView& view,
                                          const std::vector<std::uint32_t>& counts) {
    return pack_segments(view.shadow_rays.rays.read(device, 0, counts.size() * CHUNK), counts);
}

/// Of what the stage has just written into a queue.
std::uint64_t queue_digest(const Device& device, Stage stage, const WaveView& view) {
    switch (stage) {
        case Stage::generate:
            return digest_of(std::span<const Ray>(view.rays.items.read(device, view.rays.first, view.rays.count)));
        case Stage::intersect:
            return digest_of(std::span<const Hit>(view.hits.read(device, 0, view.rays.count)));
        case Stage::shade:
            return digest_of(
                std::span<const ShadowRay>(packed_shadow_rays(device, view, segment_counts(device, view))));
        case Stage::secondary:
            return digest_of(
                std::span<const Ray>(view.children->items.read(device, view.children->first, view.children->count)));
        default:
            return 0;
    }
}

}  // namespace

Request parse_request(const std::string& text) {
    const auto fail = [&](const std::string& reason) -> UsageError {
        return UsageError(fmt::format("--capture {}: {}", text, reason));
    };
    const std::size_t first = text.find(','), second = text.find(',', first + 1);
    if (first == std::string::npos || second == std::string::npos || second + 1 == text.size())
        throw fail("give depth, stage and file, as in 0,intersect,queue.wave");
    const std::string_view place = std::string_view(text).substr(0, first);
    const std::size_t colon = place.find(':');
    Request request;
    const auto depth = number<int>(place.substr(0, colon));
    if (colon != std::string_view::npos) request.launch = number<std::uint64_t>(place.substr(colon + 1));
    if (!depth || (colon != std::string_view::npos && !request.launch))
        throw fail("give the depth as a number from 0 on, or depth and launch as in 1:4");
    const std::string_view name = std::string_view(text).substr(first + 1, second - first - 1);
    const auto stage = std::ranges::find(stages, name, profile::stage_name);
    if (stage == std::end(stages))
        throw fail(fmt::format("\"{}\" is no stage: give generate, intersect, shade, shadow or secondary", name));
    if (*stage == Stage::generate && *depth != 0) throw fail("generate makes rays of depth 0 only");
    request.depth = *depth;
    request.stage = *stage;
    request.file = text.substr(second + 1);
    return request;
}

void Recorder::see(const std::string& stage, const WaveView& view) {
    if (stage != profile::stage_name(request_.stage) || view.batch.depth != request_.depth) return;
    const std::uint64_t launch = launches_++;
    if (request_.launch) {
        if (launch == *request_.launch) take(view);
        return;
    }
    const Work work{items_out(view), items_in(view)};
    if (capture_ && work <= most_) return;
    most_ = work;
    take(view);
}

std::uint64_t Recorder::items_in(const WaveView& view) const {
    return request_.stage == Stage::shadow ? shadow_ray_count(device_, view) : view.rays.count;
}

std::uint64_t Recorder::items_out(const WaveView& view) const {
    switch (request_.stage) {
        case Stage::intersect: {
            const auto hits = view.hits.read(device_, 0, view.rays.count);
            return static_cast<std::uint64_t>(
                std::ranges::count_if(hits, [](const Hit& hit) { return hit.primitive != NO_INDEX; }));
        }
        case Stage::shade:
            return shadow_ray_count(device_, view);
        case Stage::secondary:
            return view.children->count;
        default:  // generate writes what it takes; what shadow lets through only the film knows
            return 0;
    }
}

void Recorder::take(const WaveView& view) {
    const Stage stage = request_.stage;
    Capture& c = capture_.emplace();
    c.stage = stage;
    c.depth = view.batch.depth;
    c.launch = launches_ - 1;
    c.count = view.rays.count;
    if (stage == Stage::generate) c.first_sample = view.first_sample;
    if (stage == Stage::shade || stage == Stage::shadow) c.slots = view.slots;
    if (stage == Stage::intersect || stage == Stage::shade || stage == Stage::secondary)
        c.rays = view.rays.items.read(device_, view.rays.first, view.rays.count);
    if (stage == Stage::shade || stage == Stage::secondary) c.hits = view.hits.read(device_, 0, view.rays.count);
    if (stage == Stage::shadow) {
        c.shadow_counts = segment_counts(device_, view);
        c.shadow_rays = packed_shadow_rays(device_, view, c.shadow_counts);
    }
    c.digest.queue = queue_digest(device_, stage, view);
}

std::optional<Capture> Recorder::finish(const Scene& scene, Renderer& renderer, const FilmPlanes& planes) {
    if (!capture_) return std::nullopt;
    Capture& capture = *capture_;
    capture.frame = frame_key(scene, planes);
    Replay replay(device_, renderer.stages(), renderer.device_scene(), capture, film_pixels(scene));
    replay.clear();
    replay.run();
    const Digest again = replay.read().digest;
    if (again.queue != capture.digest.queue)
        throw QueueMismatch(fmt::format("launch {} of {} at depth {} writes another queue when it is repeated",
                                        capture.launch, profile::stage_name(capture.stage), capture.depth));
    capture.digest = again;
    return std::move(capture_);
}

}  // namespace raymill::capture
