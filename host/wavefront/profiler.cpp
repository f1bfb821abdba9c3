#include "wavefront/profiler.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "profile/timeline.hpp"

namespace raymill {

using profile::Detail;
using profile::Fates;
using profile::Launch;
using profile::Stage;

namespace {

constexpr double nanosecond = 1e-9;

std::int64_t event_time(const cl::Event& event, cl_profiling_info moment) {
    cl_ulong time = 0;
    event.getProfilingInfo(moment, &time);
    return static_cast<std::int64_t>(time);
}

/// How the rays of a wave went on. Throws QueueMismatch if the kernels cannot have counted so.
Fates fates_of(std::uint64_t rays, bool last_depth, std::uint64_t missed, std::uint64_t passing, std::uint64_t parents,
               std::uint64_t children) {
    const std::uint64_t hits = rays - missed;
    if (missed > rays || passing > hits || parents > passing || children < parents || children > 2 * parents)
        throw QueueMismatch(fmt::format(
            "the counts of a wave of {} rays contradict each other: {} missed, {} hit a surface that passes "
            "light on, {} of these have children, {} in all",
            rays, missed, passing, parents, children));
    Fates fates;
    fates.missed = missed;
    fates.absorbed = hits - passing;
    fates.depth_limit = last_depth ? passing : 0;
    fates.weightless = last_depth ? 0 : passing - parents;
    fates.two_children = children - parents;
    fates.one_child = parents - fates.two_children;
    return fates;
}

/// What a launch made, by the counters before and after it.
std::uint64_t items_out(const LaunchSize& size, const Fates& fates, const Counters& before, const Counters& after) {
    switch (size.stage) {
        case Stage::generate:
        case Stage::resolve:
            return size.items;
        case Stage::intersect:
            return fates.hits();
        case Stage::shade:
            return after.shadow_rays - before.shadow_rays;
        case Stage::shadow:
            return after.shadow_traced - before.shadow_traced - (after.shadow_blocked - before.shadow_blocked);
        case Stage::secondary:
            return fates.children();
        case Stage::features:
            break;
    }
    return 0;
}

}  // namespace

ClockReading read_clocks(const Device& device) {
    // The runtime stamps a command somewhere within the call that queues it: the shortest of a few calls tells best.
    constexpr std::size_t calls = 4;
    std::array<cl::Event, calls> events;
    std::array<std::int64_t, calls> before, after;
    for (std::size_t i = 0; i < calls; ++i) {
        before[i] = profile::now();
        device.queue.enqueueMarkerWithWaitList(nullptr, &events[i]);
        after[i] = profile::now();
    }
    device.queue.finish();
    std::size_t best = 0;
    for (std::size_t i = 1; i < calls; ++i)
        if (after[i] - before[i] < after[best] - before[best]) best = i;
    return {before[best] + (after[best] - before[best]) / 2, event_time(events[best], CL_PROFILING_COMMAND_QUEUED)};
}

Profiler::Profiler(const Device& device, const FrameShape& shape, Detail detail)
    : device_(device), shape_(shape), start_(profile::now()), clocks_(read_clocks(device)) {
    frame_.detail = detail;
    frame_.shadow_capacity = shape.shadow_capacity;
    wave_.before.resize(shape.passes);
    for (int depth = 0; depth <= shape.max_depth; ++depth) frame_.depths.emplace_back().depth = depth;
}

void Profiler::end_wave(const Batch& batch, std::span<const Counters> counters) {
    const Counters &before = wave_.before.front(), &after = counters.front();
    const bool last_depth = batch.depth == shape_.max_depth;
    wave_.passing = after.passing - before.passing;
    wave_.fates = fates_of(batch.count, last_depth, after.missed - before.missed, wave_.passing,
                           after.parents - before.parents, last_depth ? 0 : after.children);
    profile::Wave wave{batch.depth, batch.count, wave_.fates};
    for (std::size_t pass = 0; pass < counters.size(); ++pass) {
        wave.shadow_rays += counters[pass].shadow_rays - wave_.before[pass].shadow_rays;
        wave.shadow_blocked += counters[pass].shadow_blocked - wave_.before[pass].shadow_blocked;
    }
    count_wave(wave);
    wave_.after.assign(counters.begin(), counters.end());
    wave_.depth = batch.depth;
    wave_.number = waves_++;
    settle();  // unless that has been done
    std::swap(wave_, ended_);
    wave_.before = ended_.after;
    wave_.depth = profile::no_depth;
    wave_.number = profile::no_wave;
}

void Profiler::settle() {
    settle(ended_);
}

void Profiler::settle(PendingWave& wave) {
    std::size_t pass = 0;
    for (const auto& [size, event] : wave.launches) {
        const bool in_pass = size.stage == Stage::shade || size.stage == Stage::shadow;
        const std::size_t place = in_pass ? pass : 0;
        // resolve, which belongs to no wave, changes none.
        const Counters& before = wave.before[place];
        const Counters& after = wave.number == profile::no_wave ? before : wave.after[place];
        Launch launch;
        launch.stage = size.stage;
        launch.depth = wave.depth;
        launch.wave = wave.number;
        launch.items_in = size.stage == Stage::shadow ? after.shadow_traced - before.shadow_traced : size.items;
        launch.items_out = items_out(size, wave.fates, before, after);
        launch.work_items = size.work_items;
        launch.groups = size.groups;
        launch.places = size.places;
        launch.traffic = profile::bytes_moved(
            {size.stage, launch.items_in, launch.items_out, size.segments, wave.fates.hits(), wave.passing});
        launch.traffic.atomics = atomics_of(after, size.stage) - atomics_of(before, size.stage);
        launch.queued = event_time(event, CL_PROFILING_COMMAND_QUEUED);
        if (frame_.detail == Detail::launches) launch.submitted = event_time(event, CL_PROFILING_COMMAND_SUBMIT);
        launch.started = event_time(event, CL_PROFILING_COMMAND_START);
        launch.ended = event_time(event, CL_PROFILING_COMMAND_END);
        count(launch);
        if (size.stage == Stage::shadow) ++pass;
    }
    wave.launches.clear();
}

void Profiler::count(const Launch& launch) {
    bool& launched = launched_[static_cast<std::size_t>(launch.stage)];
    count_gap(launch, !launched);
    launched = true;
    place_of(launch.stage, launch.depth) += profile::total_of(launch, capacity_after(launch));
    if (frame_.detail == Detail::launches) frame_.launches.push_back(launch);
}

void Profiler::count_gap(const Launch& launch, bool first_launch) {
    if (last_end_ == 0) last_end_ = start_ - clocks_.host + clocks_.device;  // the frame began with an idle device
    const std::int64_t asked = std::max(launch.queued, last_end_);
    frame_.times.host += nanosecond * static_cast<double>(asked - last_end_);
    double& waited = first_launch ? frame_.times.first_launches : frame_.times.launching;
    waited += nanosecond * static_cast<double>(std::max<std::int64_t>(launch.started - asked, 0));
    frame_.times.kernels += nanosecond * static_cast<double>(launch.ended - std::max(launch.started, last_end_));
    last_end_ = launch.ended;
}

void Profiler::count_wave(const profile::Wave& wave) {
    profile::DepthTotal& total = frame_.depths[static_cast<std::size_t>(wave.depth)];
    total.fates += wave.fates;
    total.shadow_rays += wave.shadow_rays;
    total.shadow_blocked += wave.shadow_blocked;
    if (frame_.detail == Detail::launches) frame_.waves.push_back(wave);
}

std::uint64_t Profiler::capacity_after(const Launch& launch) const {
    switch (launch.stage) {
        case Stage::generate:
        case Stage::intersect:
            return shape_.queue_capacity;
        case Stage::shade:
            return shape_.shadow_capacity;
        case Stage::secondary:
            return 2 * std::uint64_t{shape_.queue_capacity};
        default:
            return 0;
    }
}

profile::StageTotal& Profiler::place_of(Stage stage, int depth) {
    const auto key = [](const profile::StageTotal& total) { return std::pair(total.stage, total.depth); };
    const auto place = std::ranges::lower_bound(frame_.stages, std::pair(stage, depth), {}, key);
    if (place != frame_.stages.end() && key(*place) == std::pair(stage, depth)) return *place;
    profile::StageTotal total;
    total.stage = stage;
    total.depth = depth;
    return *frame_.stages.insert(place, total);
}

profile::FrameProfile Profiler::finish(const Waves& waves) {
    settle(ended_);
    settle(wave_);  // of no wave: resolve
    for (profile::DepthTotal& total : frame_.depths) {
        const QueueCounts& counts = waves.counts(total.depth);
        total.capacity = waves.queue_size(total.depth);
        total.high_water = counts.high_water;
        total.pushed = counts.pushed;
        total.popped = counts.popped;
        total.waves = counts.batches;
    }
    const ClockReading end = read_clocks(device_);
    // Two clocks of one machine drift apart by some parts in a million: a line through both readings.
    const double rate = static_cast<double>(end.host - clocks_.host) /
                        static_cast<double>(std::max<std::int64_t>(end.device - clocks_.device, 1));
    const auto on_host = [&](std::int64_t& time) {
        time = clocks_.host + static_cast<std::int64_t>(rate * static_cast<double>(time - clocks_.device));
    };
    if (last_end_ == 0) last_end_ = clocks_.device;
    on_host(last_end_);
    for (Launch& launch : frame_.launches)
        for (std::int64_t* time : {&launch.queued, &launch.submitted, &launch.started, &launch.ended}) on_host(*time);
    const std::int64_t now = profile::now();
    frame_.times.host += nanosecond * static_cast<double>(now - last_end_);
    frame_.times.seconds = nanosecond * static_cast<double>(now - start_);
    return std::move(frame_);
}

}  // namespace raymill
