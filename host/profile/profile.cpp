#include "profile/profile.hpp"

#include <algorithm>

#include "layout.h"

namespace raymill::profile {

namespace {

constexpr std::array<std::string_view, stage_count> names = {"generate", "intersect", "shade",     "shadow",
                                                             "features", "tally",     "secondary", "resolve"};

/// Adds the other launches of the same stage.
void add(StageTotal& sum, const StageTotal& more) {
    sum.shortest = sum.launches == 0 ? more.shortest : std::min(sum.shortest, more.shortest);
    sum.longest = std::max(sum.longest, more.longest);
    sum.launches += more.launches;
    sum.items_in += more.items_in;
    sum.items_out += more.items_out;
    sum.work_items += more.work_items;
    sum.groups += more.groups;
    sum.places += more.places;
    sum.high_water = std::max(sum.high_water, more.high_water);
    sum.capacity = std::max(sum.capacity, more.capacity);
    sum.seconds += more.seconds;
}

const StageTotal* find(const FrameProfile& frame, Stage stage, int depth) {
    for (const StageTotal& total : frame.stages)
        if (total.stage == stage && total.depth == depth) return &total;
    return nullptr;
}

/// Hits that shade works on: every pass over the light samples goes through all hits of a wave again.
std::uint64_t shaded_hits(const FrameProfile& frame) {
    std::uint64_t hits = 0;
    for (const DepthTotal& depth : frame.depths)
        if (const StageTotal* shade = find(frame, Stage::shade, depth.depth))
            hits += depth.fates.hits() * (shade->launches / std::max<std::uint64_t>(depth.waves, 1));
    return hits;
}

/// Hits whose surface passes light on, where the recursion goes on.
std::uint64_t passing_hits(const Fates& fates) {
    return fates.weightless + fates.one_child + fates.two_children;
}

std::uint64_t camera_hits(const FrameProfile& frame) {
    return frame.depths.empty() ? 0 : frame.depths[0].fates.hits();
}

std::uint64_t camera_shadow_rays(const FrameProfile& frame) {
    return frame.depths.empty() ? 0 : frame.depths[0].shadow_rays;
}

std::uint64_t atomics_at_most(const FrameProfile& frame, const StageTotal& total) {
    constexpr std::uint64_t counters_of_a_chunk = 2;  // shadow, tally and secondary have two, shade one
    const FilmAdds& adds = frame.film_adds;
    const Fates fates = frame.fates();
    switch (total.stage) {
        case Stage::intersect:
            return camera_hits(frame) + fates.missed * adds.radiance;
        case Stage::shade:
            return 2 * fates.hits() * adds.radiance + total.work_items;  // ambient and emission
        case Stage::shadow:
            return 2 * total.items_out * adds.radiance + camera_shadow_rays(frame) * adds.shadow_ray +
                   counters_of_a_chunk * total.work_items;  // diffuse and specular
        case Stage::features:
            return camera_hits(frame) * adds.feature_hit + total.items_in * adds.feature_ray;
        case Stage::tally:
        case Stage::secondary:
            return counters_of_a_chunk * total.work_items;
        case Stage::generate:
        case Stage::resolve:
            break;
    }
    return 0;
}

}  // namespace

std::string_view stage_name(Stage stage) {
    return names[static_cast<std::size_t>(stage)];
}

Fates& Fates::operator+=(const Fates& more) {
    missed += more.missed;
    absorbed += more.absorbed;
    depth_limit += more.depth_limit;
    weightless += more.weightless;
    one_child += more.one_child;
    two_children += more.two_children;
    return *this;
}

StageTotal FrameProfile::total(Stage stage) const {
    StageTotal sum;
    sum.stage = stage;
    for (const StageTotal& one : stages)
        if (one.stage == stage) add(sum, one);
    return sum;
}

Fates FrameProfile::fates() const {
    Fates sum;
    for (const DepthTotal& depth : depths) sum += depth.fates;
    return sum;
}

std::uint64_t FrameProfile::rays() const {
    std::uint64_t sum = 0;
    for (const DepthTotal& depth : depths) sum += depth.popped;
    return sum;
}

std::uint64_t FrameProfile::shadow_rays() const {
    std::uint64_t sum = 0;
    for (const DepthTotal& depth : depths) sum += depth.shadow_rays;
    return sum;
}

std::uint64_t FrameProfile::shadow_blocked() const {
    std::uint64_t sum = 0;
    for (const DepthTotal& depth : depths) sum += depth.shadow_blocked;
    return sum;
}

Traffic traffic(const FrameProfile& frame, Stage stage) {
    const StageTotal total = frame.total(stage);
    const std::uint64_t in = total.items_in, out = total.items_out;
    Traffic traffic;
    traffic.atomics_at_most = atomics_at_most(frame, total);
    const auto moves = [&](std::uint64_t read, std::uint64_t written) {
        traffic.bytes_read = read;
        traffic.bytes_written = written;
    };
    switch (stage) {
        case Stage::generate:
            moves(0, out * sizeof(Ray));
            break;
        case Stage::intersect:
            moves(in * sizeof(Ray), in * sizeof(Hit));
            break;
        case Stage::shade: {
            const std::uint64_t counts = frame.total(Stage::shadow).work_items * sizeof(uint);
            moves(in * sizeof(Hit) + shaded_hits(frame) * sizeof(Ray), out * sizeof(ShadowRay) + counts);
            break;
        }
        case Stage::shadow:
            moves(in * sizeof(ShadowRay) + total.work_items * sizeof(uint), 0);
            break;
        case Stage::features:
            moves(in * (sizeof(Ray) + sizeof(Hit)), 0);
            break;
        case Stage::tally:
            moves(in * sizeof(Hit), 0);
            break;
        case Stage::secondary:
            moves(in * sizeof(Hit) + passing_hits(frame.fates()) * sizeof(Ray), out * sizeof(Ray));
            break;
        case Stage::resolve:
            moves(in * sizeof(std::int64_t), out * sizeof(float));
            break;
    }
    return traffic;
}

double RunProfile::unaccounted() const {
    double covered = 0;
    for (const Span& span : spans) covered += span.seconds();
    return seconds - covered;
}

}  // namespace raymill::profile
