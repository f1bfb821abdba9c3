#include "cli/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/run_profile.hpp"

namespace raymill {

namespace {

/// The first wave alone: it compiles or loads every kernel and touches the memory of every queue that it reaches.
void warm_up(Renderer& renderer) {
    renderer.render([](double) { return false; });
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

double Sweeper::time_frame() const {
    Renderer renderer(device(), scene_, bvh_, arguments_.options());
    warm_up(renderer);
    return renderer.render([this](double) { return !guard_.interrupted(); }).seconds;
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
            visit(sweep.settings[round % 2 == 0 ? i : sweep.settings.size() - 1 - i]);
            if (guard_.interrupted()) return false;
        }
    }
    return true;
}

void Sweeper::visit(profile::SweepSetting& setting) {
    if (!setting.skipped.empty() || guard_.interrupted()) return;
    try {
        measure(setting);
    } catch (const DeviceError& error) {
        setting.skipped = error.what();
        setting.frames.clear();
        setting.profile.reset();
    }
}

bool Sweeper::measure(profile::SweepSetting& setting) {
    RunClock clock;
    const RenderOptions options = options_of(setting);
    const Device& device = devices_.at(setting.threads);
    Renderer renderer(device, scene_, bvh_, options);
    setting.device_bytes = renderer.memory().total();
    setting.wave_bytes = renderer.memory().wave_bytes();
    clock.timeline.measure("warm up", [&] { warm_up(renderer); });
    const Frame timed = clock.timeline.measure("timed frame", [&] { return renderer.render(progress(setting)); });
    if (!is_whole(timed)) return false;
    setting.rays = timed.rays.total();
    setting.frames.push_back({timed.seconds, timed.hash()});
    if (setting.profile) return true;
    Frame profiled = clock.timeline.measure(
        std::string(profile::render_span), [&] { return renderer.render(progress(setting), profile::Detail::totals); });
    if (!is_whole(profiled)) return false;
    setting.profile = clock.read(scene_, device, options, renderer, profiled);
    return true;
}

bool Sweeper::record_timeline(profile::Sweep& sweep) {
    const profile::Finding finding = profile::find(sweep);
    RunClock clock;
    const profile::SweepSetting& best = sweep.settings[*finding.best];
    const RenderOptions options = options_of(best);
    const Device& device = devices_.at(best.threads);
    Renderer renderer(device, scene_, bvh_, options);
    clock.timeline.measure("warm up", [&] { warm_up(renderer); });
    Frame frame = clock.timeline.measure(std::string(profile::render_span),
                                         [&] { return renderer.render(progress(best), profile::Detail::launches); });
    if (!is_whole(frame)) return false;
    sweep.timeline = clock.read(scene_, device, options, renderer, frame);
    sweep.timeline_setting = *finding.best;
    return true;
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
