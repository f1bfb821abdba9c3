#include "capture/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace raymill::capture {

using profile::Stage;

namespace {

/// A part of a list, or where the capture has no such list, as many items to be written.
template <class T>
Buffer<T> part_of(const Device& device, const std::vector<T>& items, uint first, uint count) {
    if (items.empty()) return Buffer<T>(device, count);
    return Buffer<T>(device, std::span<const T>(items).subspan(first, count));
}

std::uint64_t hit_count(const std::vector<Hit>& hits) {
    return static_cast<std::uint64_t>(
        std::ranges::count_if(hits, [](const Hit& hit) { return hit.primitive != NO_INDEX; }));
}

Film film_of(const Device& device, std::uint64_t pixels) {
    return {{device, pixels * FILM_CHANNELS}, {device, 1}};
}

}  // namespace

Replay::Replay(const Device& device, Stages& stages, const DeviceScene& scene, const Capture& capture,
               std::uint64_t film_pixels, std::uint64_t capacity) try
    : device_(device),
      stages_(stages),
      scene_(scene),
      stage_(capture.stage),
      depth_(capture.depth),
      slots_(capture.slots),
      items_(capture.items()),
      children_(device, stage_ == Stage::secondary ? 2 * std::size_t{capture.count} : 0),
      film_(film_of(device, film_pixels * capture.frame.planes.count())) {
    film_.pixels_once = pixels_once(capture.depth, capture.frame.spp, stage_ == Stage::shadow ? slots_.count : 1);
    std::uint64_t step = capacity > 0 ? std::min<std::uint64_t>(capacity, capture.count) : capture.count;
    if (stage_ == Stage::shadow) step = std::max<std::uint64_t>(step / CHUNK, 1) * CHUNK;
    const auto places = unpack_segments(capture.shadow_rays, capture.shadow_counts);
    for (std::uint64_t first = 0; first < capture.count; first += step)
        pieces_.push_back(make_piece(capture, places, static_cast<uint>(first),
                                     static_cast<uint>(std::min<std::uint64_t>(step, capture.count - first))));
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

Replay::Piece Replay::make_piece(const Capture& capture, std::span<const ShadowRay> places, uint first,
                                 uint count) const {
    Piece piece;
    piece.first_sample = capture.first_sample + first;
    piece.count = count;
    if (stage_ == Stage::shadow) {
        piece.segments = Stages::chunks(count) * slots_.count;
        const std::size_t first_segment = std::size_t{first} / CHUNK * slots_.count;
        const auto counts = std::span(capture.shadow_counts).subspan(first_segment, piece.segments);
        piece.shadow_rays = {{device_, places.subspan(first_segment * CHUNK, counts.size() * CHUNK)},
                             {device_, counts}};
        return piece;
    }
    piece.rays = part_of(device_, capture.rays, first, count);
    if (stage_ != Stage::generate) piece.hits = part_of(device_, capture.hits, first, count);
    if (stage_ == Stage::shade) {
        piece.segments = Stages::chunks(count) * slots_.count;
        piece.shadow_rays = {{device_, std::size_t{piece.segments} * CHUNK}, {device_, piece.segments}};
    }
    return piece;
}

void Replay::clear() {
    film_.sums.clear(device_);
    film_.counters.clear(device_);
    device_.queue.finish();
}

void Replay::launch(Piece& piece) {
    const QueueRange<Ray> rays{piece.rays, 0, piece.count};
    switch (stage_) {
        case Stage::generate:
            return stages_.generate(scene_, piece.first_sample, piece.count, piece.rays);
        case Stage::intersect:
            return stages_.intersect(scene_, rays, piece.hits, film_);
        case Stage::shade:
            return stages_.shade(scene_, rays, piece.hits, slots_, piece.shadow_rays, film_);
        case Stage::shadow:
            return stages_.shadow(scene_, piece.shadow_rays, piece.segments, film_);
        default:
            return stages_.secondary(scene_, rays, piece.hits, {children_}, film_);
    }
}

void Replay::run() try {
    for (Piece& piece : pieces_) launch(piece);
    device_.queue.finish();
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

Outcome Replay::read() const try {
    const Counters counters = film_.counters.read_one(device_);
    if (counters.children > children_.size())
        throw QueueOverflow(
            fmt::format("{} rays were pushed into a queue that holds {}", counters.children, children_.size()));
    Outcome outcome;
    outcome.digest.queue = queue_digest(counters, outcome.items_out);
    outcome.digest.film = digest_of(std::span<const cl_long>(film_.sums.read(device_)), counters);
    return outcome;
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

std::uint64_t Replay::queue_digest(const Counters& counters, std::uint64_t& items_out) const {
    if (stage_ == Stage::shadow) {
        items_out = counters.shadow_traced - counters.shadow_blocked;
        return 0;
    }
    if (stage_ == Stage::secondary) {
        items_out = counters.children;
        return digest_of(std::span<const Ray>(children_.read(device_, 0, counters.children)));
    }
    std::uint64_t digest = 0, first = 0;
    for (const Piece& piece : pieces_) {
        if (stage_ == Stage::generate) {
            digest += digest_of(std::span<const Ray>(piece.rays.read(device_)));
            items_out += piece.count;
        } else if (stage_ == Stage::intersect) {
            const std::vector<Hit> hits = piece.hits.read(device_);
            digest += digest_of(std::span<const Hit>(hits), first);
            items_out += hit_count(hits);
        } else {
            const auto rays =
                pack_segments(piece.shadow_rays.rays.read(device_), piece.shadow_rays.counts.read(device_));
            digest += digest_of(std::span<const ShadowRay>(rays));
            items_out += rays.size();
        }
        first += piece.count;
    }
    return digest;
}

profile::Traffic Replay::traffic(const Outcome& outcome) try {
    film_.counted = true;
    clear();
    run();
    const std::uint64_t atomics = atomics_of(film_.counters.read_one(device_), stage_);

    profile::QueueItems moved{stage_, items_, outcome.items_out};
    clear();
    for (Piece& piece : pieces_) {
        moved.segments += piece.segments;
        if (stage_ == Stage::shade) moved.hits += hit_count(piece.hits.read(device_));
        // Which hits pass light on, shade counts.
        if (stage_ == Stage::secondary)
            stages_.shade(scene_, {piece.rays, 0, piece.count}, piece.hits, {}, piece.shadow_rays, film_);
    }
    moved.passing = film_.counters.read_one(device_).passing;
    film_.counted = false;
    profile::Traffic traffic = profile::bytes_moved(moved);
    traffic.atomics = atomics;
    return traffic;
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

WaveView Replay::view() const {
    assert(pieces_.size() == 1);
    const Piece& piece = pieces_.front();
    const auto children = static_cast<uint>(film_.counters.read_one(device_).children);
    return {{depth_, 0, piece.count},
            {piece.rays, 0, piece.count},
            piece.hits,
            slots_,
            piece.shadow_rays,
            QueueRange<Ray>{children_, 0, children},
            film_,
            piece.first_sample};
}

}  // namespace raymill::capture
