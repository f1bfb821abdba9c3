#include "sweep_example.hpp"

#include "run_example.hpp"

namespace raymill::profile {

namespace {

constexpr std::uint64_t film_hash = 0xfeed;

}  // namespace

SweepSetting setting_of(std::uint64_t capacity, std::uint64_t work_group, const std::vector<double>& seconds) {
    SweepSetting setting;
    setting.queue_capacity = capacity;
    setting.work_group = work_group;
    setting.threads = 2;
    setting.device_bytes = 1000 * capacity;
    setting.wave_bytes = 200 * capacity;
    setting.rays = 1200;
    for (const double s : seconds) setting.frames.push_back({s, film_hash});
    setting.profile = run_example();
    setting.profile->queue_capacity = capacity;
    setting.profile->film_hash = film_hash;
    setting.profile->frame.detail = Detail::totals;
    return setting;
}

Sweep sweep_example() {
    const RunProfile run = run_example();
    Sweep sweep;
    sweep.version = "1.2.3";
    sweep.scene = run.scene;
    sweep.width = run.width;
    sweep.height = run.height;
    sweep.samples_per_pixel = 3;
    sweep.scene_samples_per_pixel = 16;
    sweep.samples_chosen = true;
    sweep.device = run.device;
    sweep.device_memory = 1 << 30;
    sweep.caches = {{"L1d", 16384, 1}, {"L2", 40960, 2}};
    sweep.repeats = 2;
    sweep.seconds = 0.5;
    sweep.settings = {setting_of(64, 0, {19.5e-6, 20.5e-6}), setting_of(128, 0, {12.25e-6, 12.75e-6}),
                      setting_of(256, 0, {11.5e-6, 12.5e-6}), setting_of(512, 0, {}),
                      setting_of(128, 8, {14.5e-6, 15.5e-6})};
    sweep.settings[3].skipped = "the frame needs 3 GiB";
    sweep.settings[3].profile.reset();
    sweep.timeline = run;
    sweep.timeline_setting = 2;
    return sweep;
}

}  // namespace raymill::profile
