#include "run_example.hpp"

namespace raymill::profile {

namespace {

constexpr std::uint64_t capacity = 128;

void add_launch(FrameProfile& frame, int depth, std::uint32_t wave, QueueItems items, std::uint64_t work_items,
                std::uint64_t places, std::uint64_t atomics) {
    Launch launch;
    launch.stage = items.stage;
    launch.depth = depth;
    launch.wave = wave;
    launch.items_in = items.in;
    launch.items_out = items.out;
    launch.work_items = launch.groups = work_items;
    launch.places = places;
    launch.traffic = bytes_moved(items);
    launch.traffic.atomics = atomics;
    launch.queued = 2'000'000 + 10'000 * static_cast<std::int64_t>(frame.launches.size());
    launch.submitted = launch.queued + 1000;
    launch.started = launch.queued + 2000;
    launch.ended = launch.queued + 9000;
    frame.launches.push_back(launch);

    const StageTotal one = total_of(launch, capacity);
    for (StageTotal& total : frame.stages)
        if (total.stage == one.stage && total.depth == depth) {
            total += one;
            return;
        }
    frame.stages.push_back(one);
}

}  // namespace

RunProfile run_example() {
    RunProfile run;
    run.scene = "example.toml";
    run.device = "an abacus";
    run.width = run.height = 10;
    run.samples_per_pixel = 1;
    run.queue_capacity = capacity;
    run.start = 1'000'000;
    run.seconds = 0.002;
    run.spans = {{"load scene", 1'000'000, 1'500'000}, {std::string(render_span), 1'900'000, 2'900'000}};
    FrameProfile& frame = run.frame;
    frame.detail = Detail::launches;
    add_launch(frame, 0, 0, {Stage::generate, 100, 100}, 100, 128, 0);
    add_launch(frame, 0, 0, {Stage::intersect, 100, 70}, 2, 128, 150);
    for (const std::uint64_t lit : {60, 65}) {
        add_launch(frame, 0, 0, {Stage::shade, 100, 70, 2, 70}, 2, 128, 200);
        add_launch(frame, 0, 0, {Stage::shadow, 70, lit, 2}, 2, 128, 3 * lit);
    }
    add_launch(frame, 0, 0, {Stage::secondary, 100, 60, 0, 70, 55}, 2, 128, 2);
    add_launch(frame, 1, 1, {Stage::intersect, 60, 0}, 1, 64, 180);
    add_launch(frame, no_depth, no_wave, {Stage::resolve, 400, 400}, 400, 448, 0);
    const Fates first{30, 15, 0, 5, 40, 10}, second{60, 0, 0, 0, 0, 0};
    frame.depths = {{0, capacity, 100, 100, 100, 1, first, 140, 15}, {1, 2 * capacity, 60, 60, 60, 1, second, 0, 0}};
    frame.waves = {{0, 100, first, 140, 15}, {1, 60, second, 0, 0}};
    frame.times = {0.001, 63e-6, 0, 10e-6, 927e-6};
    return run;
}

}  // namespace raymill::profile
