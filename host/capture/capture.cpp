#include "capture/capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "capture/capture_file.hpp"
#include "common/error.hpp"
#include "wavefront/records.hpp"

namespace raymill::capture {

using profile::Stage;

namespace {

namespace fs = std::filesystem;

void apply(const FrameKey& key, RenderSettings& settings) {
    settings.width = key.width;
    settings.height = key.height;
    settings.spp = key.spp;
    settings.depth = key.depth;
    settings.seed = key.seed;
    settings.crop = key.crop;
}

bool makes_an_image(const FrameKey& key) {
    RenderSettings settings;
    apply(key, settings);
    const auto side = [](int pixels) { return pixels >= 1 && pixels <= largest_side; };
    const auto share = [](double low, double high) { return low >= 0 && low < high && high <= 1; };
    if (!side(key.width) || !side(key.height) || key.spp < 1 || key.depth < 0) return false;
    if (!share(key.crop.x0, key.crop.x1) || !share(key.crop.y0, key.crop.y1)) return false;
    const PixelWindow window = crop_window(settings);
    return window.width >= 1 && window.height >= 1;
}

/// Whether the lists that the stage reads are there, and as long as each other.
bool is_complete(const Capture& c) {
    const bool has_hits = c.stage == Stage::shade || c.stage == Stage::secondary;
    const bool has_rays = has_hits || c.stage == Stage::intersect;
    const bool has_slots = c.stage == Stage::shade || c.stage == Stage::shadow;
    const std::size_t segments =
        c.stage == Stage::shadow ? std::size_t{Stages::chunks(c.count)} * c.slots.count : std::size_t{0};
    const std::uint64_t pushed = std::accumulate(c.shadow_counts.begin(), c.shadow_counts.end(), std::uint64_t{0});
    return std::ranges::find(stages, c.stage) != std::end(stages) && c.rays.size() == (has_rays ? c.count : 0) &&
           c.hits.size() == (has_hits ? c.count : 0) && (has_slots || c.slots.count == 0) &&
           c.slots.count <= SHADOW_SAMPLES && c.shadow_counts.size() == segments && c.shadow_rays.size() == pushed &&
           std::ranges::all_of(c.shadow_counts, [](std::uint32_t count) { return count <= CHUNK; });
}

}  // namespace

FrameKey frame_key(const Scene& scene, const FilmPlanes& planes) {
    const RenderSettings& s = scene.settings;
    return {fs::absolute(scene.file).lexically_normal().string(),
            scene.hash,
            s.width,
            s.height,
            s.spp,
            s.depth,
            s.seed,
            s.crop,
            planes};
}

std::uint64_t Capture::items() const {
    return stage == Stage::shadow ? shadow_rays.size() : count;
}

std::vector<ShadowRay> pack_segments(const std::vector<ShadowRay>& places, const std::vector<std::uint32_t>& counts) {
    std::vector<ShadowRay> rays;
    for (std::size_t segment = 0; segment < counts.size(); ++segment) {
        const auto begin = places.begin() + static_cast<std::ptrdiff_t>(segment * CHUNK);
        rays.insert(rays.end(), begin, begin + counts[segment]);
    }
    return rays;
}

std::vector<ShadowRay> unpack_segments(const std::vector<ShadowRay>& rays, const std::vector<std::uint32_t>& counts) {
    std::vector<ShadowRay> places(counts.size() * CHUNK);
    auto next = rays.begin();
    for (std::size_t segment = 0; segment < counts.size(); ++segment) {
        const auto end = next + counts[segment];
        std::copy(next, end, places.begin() + static_cast<std::ptrdiff_t>(segment * CHUNK));
        next = end;
    }
    return places;
}

bool fits(const Capture& capture, const Scene& scene) {
    const std::uint64_t pixels = film_pixels(scene);
    const std::uint64_t samples = pixels * static_cast<std::uint64_t>(scene.settings.spp);
    const std::uint64_t generated = capture.stage == Stage::generate ? capture.count : 0;
    const auto on_film = [&](const auto& ray) { return ray.pixel < pixels && ray.route <= ROUTE_REFRACTED; };
    const auto in_scene = [&](const Hit& hit) {
        return hit.primitive == NO_INDEX || hit.primitive < scene.primitive_count();
    };
    return is_complete(capture) && capture.depth >= 0 && capture.depth <= scene.settings.depth &&
           capture.first_sample <= samples && generated <= samples - capture.first_sample &&
           std::uint64_t{capture.slots.first} + capture.slots.count <= light_slots(scene).size() &&
           std::ranges::all_of(capture.rays, on_film) && std::ranges::all_of(capture.shadow_rays, on_film) &&
           std::ranges::all_of(capture.hits, in_scene);
}

LoadedCapture load_capture(const std::string& file, const std::string& scene_file, const std::string& scene_argument) {
    LoadedCapture loaded{read_capture(file), {}};
    const FrameKey& key = loaded.capture.frame;
    const std::string& place = scene_file.empty() ? key.scene_file : scene_file;
    std::error_code unreadable;
    if (scene_file.empty() && !fs::exists(place, unreadable))
        throw UsageError(fmt::format("{} was captured from {}, which is not there: say with {} where the scene is now",
                                     file, place, scene_argument));
    loaded.scene = load_scene(place);
    if (loaded.scene.hash != key.scene_hash)
        throw UsageError(
            fmt::format("{} was captured from a scene with the hash {:016x}, and {} has {:016x}: capture "
                        "it again, or give the scene that it is from with {}",
                        file, key.scene_hash, place, loaded.scene.hash, scene_argument));
    if (makes_an_image(key)) {
        apply(key, loaded.scene.settings);
        if (fits(loaded.capture, loaded.scene)) return loaded;
    }
    throw UsageError(fmt::format("{}: the captured queue does not fit its own scene: capture it again", file));
}

}  // namespace raymill::capture
