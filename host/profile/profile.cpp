#include "profile/profile.hpp"

#include <algorithm>

#include "layout.h"

namespace raymill::profile {

namespace {

constexpr std::array<std::string_view, stage_count> names = {"generate", "intersect", "shade",  "shadow",
                                                             "features", "secondary", "resolve"};

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

Traffic& Traffic::operator+=(const Traffic& more) {
    bytes_read += more.bytes_read;
    bytes_written += more.bytes_written;
    atomics += more.atomics;
    return *this;
}

Traffic bytes_moved(const QueueItems& items) {
    const std::uint64_t counts = items.segments * sizeof(uint);
    switch (items.stage) {
        case Stage::generate:
            return {0, items.out * sizeof(Ray)};
        case Stage::intersect:
            return {items.in * sizeof(Ray), items.in * sizeof(Hit)};
        case Stage::shade:
            return {items.in * sizeof(Hit) + items.hits * sizeof(Ray), items.out * sizeof(ShadowRay) + counts};
        case Stage::shadow:
            return {items.in * sizeof(ShadowRay) + counts, 0};
        case Stage::features:
            return {items.in * (sizeof(Ray) + sizeof(Hit)), 0};
        case Stage::secondary:
            return {items.in * sizeof(Hit) + items.passing * sizeof(Ray), items.out * sizeof(Ray)};
        case Stage::resolve:
            return {items.in * sizeof(std::int64_t), items.out * sizeof(float)};
    }
    return {};
}

StageTotal& StageTotal::operator+=(const StageTotal& more) {
    shortest = launches == 0 ? more.shortest : std::min(shortest, more.shortest);
    longest = std::max(longest, more.longest);
    launches += more.launches;
    items_in += more.items_in;
    items_out += more.items_out;
    work_items += more.work_items;
    groups += more.groups;
    places += more.places;
    high_water = std::max(high_water, more.high_water);
    capacity = std::max(capacity, more.capacity);
    traffic += more.traffic;
    seconds += more.seconds;
    return *this;
}

StageTotal total_of(const Launch& launch, std::uint64_t capacity) {
    const double seconds = 1e-9 * static_cast<double>(launch.ended - launch.started);
    return {
        launch.stage,  launch.depth,     1,        launch.items_in, launch.items_out, launch.work_items, launch.groups,
        launch.places, launch.items_out, capacity, launch.traffic,  seconds,          seconds,           seconds};
}

StageTotal FrameProfile::total(Stage stage) const {
    StageTotal sum;
    sum.stage = stage;
    for (const StageTotal& one : stages)
        if (one.stage == stage) sum += one;
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

double RunProfile::unaccounted() const {
    double covered = 0;
    for (const Span& span : spans) covered += span.seconds();
    return seconds - covered;
}

}  // namespace raymill::profile
