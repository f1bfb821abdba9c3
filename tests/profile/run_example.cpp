#include "run_example.hpp"

namespace raymill::profile {

namespace {

struct Counts {
    std::uint64_t in, out, work_items, places;
};

void add_launch(FrameProfile& frame, Stage stage, int depth, std::uint32_t wave, Counts counts) {
    const std::int64_t time = 2'000'000 + 10'000 * static_cast<std::int64_t>(frame.launches.size());
    frame.launches.push_back({stage, depth, wave, counts.in, counts.out, counts.work_items, counts.work_items,
                              counts.places, time, time + 1000, time + 2000, time + 9000});
    for (StageTotal& total : frame.stages)
        if (total.stage == stage && total.depth == depth) {
            ++total.launches;
            total.items_in += counts.in;
            total.items_out += counts.out;
            total.work_items += counts.work_items;
            total.groups += counts.work_items;
            total.places += counts.places;
            total.seconds += 7e-6;
            return;
        }
    frame.stages.push_back({stage, depth, 1, counts.in, counts.out, counts.work_items, counts.work_items, counts.places,
                            counts.out, 128, 7e-6, 7e-6, 7e-6});
}

}  // namespace

RunProfile run_example() {
    RunProfile run;
    run.scene = "example.toml";
    run.device = "an abacus";
    run.width = run.height = 10;
    run.samples_per_pixel = 1;
    run.queue_capacity = 128;
    run.start = 1'000'000;
    run.seconds = 0.002;
    run.spans = {{"load scene", 1'000'000, 1'500'000}, {std::string(render_span), 1'900'000, 2'900'000}};
    FrameProfile& frame = run.frame;
    frame.detail = Detail::launches;
    add_launch(frame, Stage::generate, 0, 0, {100, 100, 100, 128});
    add_launch(frame, Stage::intersect, 0, 0, {100, 70, 2, 128});
    for (const std::uint64_t lit : {60, 65}) {
        add_launch(frame, Stage::shade, 0, 0, {100, 70, 2, 128});
        add_launch(frame, Stage::shadow, 0, 0, {70, lit, 2, 128});
    }
    add_launch(frame, Stage::secondary, 0, 0, {100, 60, 2, 128});
    add_launch(frame, Stage::intersect, 1, 1, {60, 0, 1, 64});
    add_launch(frame, Stage::resolve, no_depth, no_wave, {400, 400, 400, 448});
    const Fates first{30, 15, 0, 5, 40, 10}, second{60, 0, 0, 0, 0, 0};
    frame.depths = {{0, 128, 100, 100, 100, 1, first, 140, 15}, {1, 256, 60, 60, 60, 1, second, 0, 0}};
    frame.waves = {{0, 100, first, 140, 15}, {1, 60, second, 0, 0}};
    frame.times = {0.001, 63e-6, 0, 10e-6, 927e-6};
    return run;
}

}  // namespace raymill::profile
