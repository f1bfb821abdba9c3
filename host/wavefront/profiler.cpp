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

profile::FilmAdds film_adds(const FilmPlanes& planes) {
    profile::FilmAdds adds;
    for (int plane = FILM_AMBIENT; plane <= FILM_REFRACTION; ++plane)
        if (planes.keeps(plane)) adds.radiance = 6;
    adds.shadow_ray = planes.keeps(FILM_SHADOW) ? 4 : 0;
    adds.feature_hit =
        3u * planes.keeps(FILM_ALBEDO) + 3u * planes.keeps(FILM_NORMAL) + 4u * planes.keeps(FILM_POSITION);
    adds.feature_ray = planes.keeps(FILM_IDS) ? 2 : 0;
    return adds;
}

}  // namespace

ClockReading read_clocks(const Device& device) {
    // The runtime stamps a command somewhere within the call that queues it: the shortest of a few calls tells best.
    ClockReading best;
    std::int64_t shortest = INT64_MAX;
    for (int i = 0; i < 4; ++i) {
        cl::Event event;
        const std::int64_t before = profile::now();
        device.queue.enqueueMarkerWithWaitList(nullptr, &event);
        const std::int64_t after = profile::now();
        device.queue.finish();
        if (after - before >= shortest) continue;
        shortest = after - before;
        best = {before + shortest / 2, event_time(event, CL_PROFILING_COMMAND_QUEUED)};
    }
    return best;
}

Profiler::Profiler(const Device& device, const FrameShape& shape, Detail detail)
    : device_(device), shape_(shape), passes_(shape.passes), start_(profile::now()), clocks_(read_clocks(device)) {
    frame_.detail = detail;
    frame_.shadow_capacity = shape.shadow_capacity;
    frame_.film_adds = film_adds(shape.planes);
    for (int depth = 0; depth <= shape.max_depth; ++depth) frame_.depths.emplace_back().depth = depth;
}

void Profiler::end_pass(const Buffer<Counters>& counters) {
    if (pass_ + 1 < shape_.passes)  // the last one's are what the wave leaves
        device_.queue.enqueueReadBuffer(counters.memory(), CL_FALSE, 0, sizeof(Counters), &passes_[pass_]);
    ++pass_;
}

void Profiler::end_wave(const Batch& batch, const Counters& counters) {
    const bool last_depth = batch.depth == shape_.max_depth;
    const std::uint64_t children = last_depth ? 0 : counters.children;
    profile::Wave wave;
    wave.depth = batch.depth;
    wave.rays = batch.count;
    wave.fates = fates_of(batch.count, last_depth, counters.missed - before_.missed, counters.passing - before_.passing,
                          counters.parents - before_.parents, children);
    wave.shadow_rays = counters.shadow_rays - before_.shadow_rays;
    wave.shadow_blocked = counters.shadow_blocked - before_.shadow_blocked;
    count_wave(wave);

    passes_.back() = counters;
    Launch launch;
    launch.depth = batch.depth;
    launch.wave = waves_++;
    settle(before_, launch, wave.fates.hits(), children);
    before_ = counters;
    pass_ = 0;
}

/// Turns the pending launches into counts: what they are, `launch` says but for what is each launch's own. counters: as
/// they were before.
void Profiler::settle(const Counters& counters, Launch launch, std::uint64_t hits, std::uint64_t children) {
    Counters before = counters;
    std::size_t pass = 0;
    for (const auto& [size, event] : pending_) {
        const Counters& after = passes_[std::min(pass, passes_.size() - 1)];
        launch.stage = size.stage;
        launch.items_in = size.items;
        launch.work_items = size.work_items;
        launch.groups = size.groups;
        launch.places = size.places;
        launch.items_out = 0;
        if (size.stage == Stage::generate || size.stage == Stage::resolve) launch.items_out = size.items;
        if (size.stage == Stage::intersect) launch.items_out = hits;
        if (size.stage == Stage::secondary) launch.items_out = children;
        if (size.stage == Stage::shade) launch.items_out = after.shadow_rays - before.shadow_rays;
        if (size.stage == Stage::shadow) {
            launch.items_in = after.shadow_traced - before.shadow_traced;
            launch.items_out = launch.items_in - (after.shadow_blocked - before.shadow_blocked);
            before = after;
            ++pass;
        }
        count(launch, {event_time(event, CL_PROFILING_COMMAND_QUEUED), event_time(event, CL_PROFILING_COMMAND_SUBMIT),
                       event_time(event, CL_PROFILING_COMMAND_START), event_time(event, CL_PROFILING_COMMAND_END)});
    }
    pending_.clear();
}

void Profiler::count(const Launch& launch, const Times& times) {
    const auto same_stage = [&](const profile::StageTotal& total) { return total.stage == launch.stage; };
    count_gap(times, std::ranges::none_of(frame_.stages, same_stage));
    const double seconds = nanosecond * static_cast<double>(times.ended - times.started);
    profile::StageTotal& total = total_of(launch.stage, launch.depth);
    total.shortest = total.launches == 0 ? seconds : std::min(total.shortest, seconds);
    total.longest = std::max(total.longest, seconds);
    ++total.launches;
    total.items_in += launch.items_in;
    total.items_out += launch.items_out;
    total.work_items += launch.work_items;
    total.groups += launch.groups;
    total.places += launch.places;
    total.high_water = std::max(total.high_water, launch.items_out);
    total.capacity = capacity_after(launch);
    total.seconds += seconds;
    if (frame_.detail != Detail::launches) return;
    Launch& kept = frame_.launches.emplace_back(launch);
    kept.queued = times.queued;
    kept.submitted = times.submitted;
    kept.started = times.started;
    kept.ended = times.ended;
}

void Profiler::count_gap(const Times& times, bool first_launch) {
    if (last_end_ == 0) last_end_ = start_ - clocks_.host + clocks_.device;  // the frame began with an idle device
    const std::int64_t asked = std::max(times.queued, last_end_);
    frame_.times.host += nanosecond * static_cast<double>(asked - last_end_);
    double& waited = first_launch ? frame_.times.first_launches : frame_.times.launching;
    waited += nanosecond * static_cast<double>(std::max<std::int64_t>(times.started - asked, 0));
    frame_.times.kernels += nanosecond * static_cast<double>(times.ended - std::max(times.started, last_end_));
    last_end_ = times.ended;
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

profile::StageTotal& Profiler::total_of(Stage stage, int depth) {
    const auto key = [](const profile::StageTotal& total) { return std::pair(total.stage, total.depth); };
    const auto place = std::ranges::lower_bound(frame_.stages, std::pair(stage, depth), {}, key);
    if (place != frame_.stages.end() && key(*place) == std::pair(stage, depth)) return *place;
    profile::StageTotal total;
    total.stage = stage;
    total.depth = depth;
    return *frame_.stages.insert(place, total);
}

profile::FrameProfile Profiler::finish(const Waves& waves) {
    settle(before_, {}, 0, 0);
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
