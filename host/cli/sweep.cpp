#include "cli/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace raymill {

namespace {

// An interrupt may end a frame, and also make a device fail: when a signal comes, LLVM removes the files that it is
// about to write, and the kernels do not build. Neither says anything of the setting.

/// The first wave of each pipeline alone: they compile or load every kernel and touch the memory of every queue that
/// they reach.
void warm_up(Renderer& renderer) {
    int waves = renderer.memory().pipelines;
    renderer.render([&](double) { return --waves > 0; });
}

bool is_whole(const Frame& frame) {
    return frame.finished == 1;
}

}  // namespace

Sweeper::Sweeper(const DeviceArguments& arguments, const SweepLists& lists, const Scene& scene, const Bvh& bvh,
                 const InterruptGuard& guard, ProgressBar& bar)
    : arguments_(arguments), lists_(lists), scene_(scene), bvh_(bvh), guard_(guard), bar_(bar) {
    for (const std::uint32_t threads : lists.threads) {
        try {
            Device device = open_device(arguments.device, threads);
            const unsigned units = device.info.compute_units;
            devices_.emplace(units, std::move(device));
        } catch (const DeviceError& error) {
            refused_.emplace(threads, error.what());
        }
    }
    if (devices_.empty()) throw DeviceError(refused_.begin()->second);
}

RenderOptions Sweeper::options_of(const profile::SweepSetting& setting) const {
    RenderOptions options = arguments_.options();
    options.memory.queue_capacity = setting.queue_capacity;
    options.work_group = setting.work_group;
    return options;
}

std::optional<double> Sweeper::time_frame() const try {
    Renderer renderer(device(), scene_, bvh_, arguments_.options());
    warm_up(renderer);
    const Frame frame = renderer.render([this](double) { return !guard_.interrupted(); });
    return is_whole(frame) ? std::optional(frame.seconds) : std::nullopt;
} catch (const DeviceError&) {
    if (!guard_.interrupted()) throw;
    return std::nullopt;
}

void Sweeper::add_settings(profile::Sweep& sweep) const {
    const auto add = [&](unsigned threads, const std::string& why_not) {
        for (const std::uint32_t work_group : lists_.work_groups)
            for (const std::uint32_t capacity : lists_.queue_capacities) {
                profile::SweepSetting setting;
                setting.queue_capacity = capacity;
                setting.work_group = work_group;
                setting.threads = threads;
                setting.skipped = why_not;
                sweep.settings.push_back(std::move(setting));
            }
    };
    for (const auto& [threads, device] : devices_) add(threads, "");
    for (const auto& [threads, why_not] : refused_) add(threads, why_not);
}

void Sweeper::run(profile::Sweep& sweep) {
    const std::int64_t began = profile::now();
    sweep.repeats = lists_.repeats;
    add_settings(sweep);
    visits_ = sweep.settings.size() * static_cast<std::size_t>(lists_.repeats) + 1;
    visits_done_ = 0;
    sweep.complete = rounds(sweep);
    const auto skipped = [](const profile::SweepSetting& setting) { return !setting.skipped.empty(); };
    if (std::ranges::all_of(sweep.settings, skipped)) throw DeviceError(sweep.settings.front().skipped);
    sweep.complete = sweep.complete && record_timeline(sweep);
    sweep.seconds = 1e-9 * static_cast<double>(profile::now() - began);
    bar_.clear();
}

bool Sweeper::rounds(profile::Sweep& sweep) {
    for (int round = 0; round < lists_.repeats; ++round) {
        for (std::size_t i = 0; i < sweep.settings.size(); ++i, ++visits_done_) {
            visit(sweep, round % 2 == 0 ? i : sweep.settings.size() - 1 - i);
            if (guard_.interrupted()) return false;
        }
    }
    return true;
}

void Sweeper::visit(profile::Sweep& sweep, std::size_t index) {
    profile::SweepSetting& setting = sweep.settings[index];
    if (!setting.skipped.empty() || guard_.interrupted()) return;
    try {
        measure(sweep, index);
    } catch (const DeviceError& error) {
        if (guard_.interrupted()) return;
        setting.skipped = error.what();
        setting.frames.clear();
        setting.profile.reset();
    }
}

void Sweeper::measure(profile::Sweep& sweep, std::size_t index) {
    profile::SweepSetting& setting = sweep.settings[index];
    RunClock clock;
    const RenderOptions options = options_of(setting);
    const Device& device = devices_.at(setting.threads);
    Renderer renderer(device, scene_, bvh_, options);
    setting.device_bytes = renderer.memory().total();
    setting.wave_bytes = renderer.memory().wave_bytes();
    setting.pipelines = renderer.memory().pipelines;
    clock.timeline.measure("warm up", [&] { warm_up(renderer); });
    std::optional<profile::RunProfile> run;
    if (!setting.profile) {
        // Before the timed frame, so that an interrupt leaves no setting that has the one without the other.
        run = profiled_frame(clock, device, options, renderer, setting);
        if (!run) return;
    }
    const Frame timed = renderer.render(progress(setting));
    if (!is_whole(timed)) return;
    setting.rays = timed.rays.total();
    setting.frames.push_back({timed.seconds, timed.hash()});
    if (run) keep_profile(sweep, index, std::move(*run));
}

std::optional<profile::RunProfile> Sweeper::profiled_frame(RunClock& clock, const Device& device,
                                                           const RenderOptions& options, Renderer& renderer,
                                                           const profile::SweepSetting& setting) {
    Frame frame = clock.timeline.measure(std::string(profile::render_span),
                                         [&] { return renderer.render(progress(setting), profile::Detail::launches); });
    if (!is_whole(frame)) return std::nullopt;
    return clock.read(scene_, device, options, renderer, frame);
}

/// The launches are those of the sweep's timeline if this is the fastest setting so far; else only their totals stay.
void Sweeper::keep_profile(profile::Sweep& sweep, std::size_t index, profile::RunProfile run) {
    const auto rate = [&](std::size_t i) { return profile::rays_per_second(sweep.settings[i]); };
    if (!sweep.timeline || rate(index) > rate(sweep.timeline_setting)) {
        sweep.timeline = run;
        sweep.timeline_setting = index;
    }
    run.frame.detail = profile::Detail::totals;
    run.frame.launches = {};
    run.frame.waves = {};
    sweep.settings[index].profile = std::move(run);
}

bool Sweeper::record_timeline(profile::Sweep& sweep) try {
    const std::size_t best_index = *profile::find(sweep).best;
    const profile::SweepSetting& best = sweep.settings[best_index];
    RunClock clock;
    const RenderOptions options = options_of(best);
    const Device& device = devices_.at(best.threads);
    Renderer renderer(device, scene_, bvh_, options);
    clock.timeline.measure("warm up", [&] { warm_up(renderer); });
    std::optional<profile::RunProfile> run = profiled_frame(clock, device, options, renderer, best);
    if (!run) return false;
    sweep.timeline = std::move(run);
    sweep.timeline_setting = best_index;
    return true;
} catch (const DeviceError&) {
    if (!guard_.interrupted()) throw;
    return false;
}

Progress Sweeper::progress(const profile::SweepSetting& setting) {
    std::string note = fmt::format("{} rays, work-group {}, {} threads", setting.queue_capacity,
                                   profile::work_group_name(setting.work_group), setting.threads);
    return [this, note = std::move(note)](double share) {
        bar_.show((static_cast<double>(visits_done_) + share) / static_cast<double>(visits_), note);
        return !guard_.interrupted();
    };
}

}  // namespace raymill
