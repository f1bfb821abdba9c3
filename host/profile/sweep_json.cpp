#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "profile/json.hpp"
#include "profile/sweep_output.hpp"

namespace raymill::profile {

using Json = nlohmann::ordered_json;

namespace {

constexpr int format_version = 1;

Json scene_json(const Sweep& sweep) {
    return {{"file", sweep.scene},
            {"width", sweep.width},
            {"height", sweep.height},
            {"depth", sweep.depth},
            {"samples_per_pixel", sweep.samples_per_pixel},
            {"samples_chosen", sweep.samples_chosen},
            {"scene_samples_per_pixel", sweep.scene_samples_per_pixel},
            {"primitives", sweep.primitives}};
}

Json device_json(const Sweep& sweep) {
    Json caches = Json::array();
    for (const Cache& cache : sweep.caches)
        caches.push_back({{"name", cache.name}, {"bytes", cache.bytes}, {"sharers", cache.sharers}});
    return {{"name", sweep.device},
            {"platform", sweep.platform},
            {"driver", sweep.driver},
            {"memory", sweep.device_memory},
            {"caches", std::move(caches)}};
}

Json index_json(const std::optional<std::size_t>& index) {
    return index ? Json(*index) : Json();
}

Json finding_json(const Sweep& sweep) {
    const Finding finding = find(sweep);
    return {{"headline", headline(sweep, finding)},
            {"best", index_json(finding.best)},
            {"knee", index_json(finding.knee)},
            {"knee_tolerance", knee_tolerance},
            {"below_knee", index_json(finding.below_knee)},
            {"loss_below_knee", finding.loss_below_knee},
            {"as_good", finding.as_good},
            {"same_image", finding.same_image()},
            {"film_hash", finding.film_hash ? Json(fmt::format("{:016x}", *finding.film_hash)) : Json()},
            {"other_image", finding.other_image}};
}

std::string state_name(const SweepSetting& setting, int repeats) {
    if (!setting.skipped.empty()) return "skipped";
    if (setting.frames.empty()) return "not_reached";
    return std::cmp_less(setting.frames.size(), repeats) ? "partial" : "measured";
}

Json frames_json(const SweepSetting& setting) {
    Json frames = Json::array();
    for (const TimedFrame& frame : setting.frames)
        frames.push_back({{"seconds", frame.seconds}, {"film_hash", fmt::format("{:016x}", frame.film_hash)}});
    return frames;
}

Json setting_json(const SweepSetting& setting, int repeats) {
    Json json = {{"queue_capacity", setting.queue_capacity},
                 {"work_group", setting.work_group},
                 {"threads", setting.threads},
                 {"state", state_name(setting, repeats)},
                 {"skipped", setting.skipped.empty() ? Json() : Json(setting.skipped)},
                 {"device_bytes", setting.device_bytes},
                 {"wave_bytes", setting.wave_bytes},
                 {"pipelines", setting.pipelines}};
    if (!setting.measured()) return json;
    const Spread seconds = spread(setting);
    json["rays"] = setting.rays;
    json["rays_per_second"] = rays_per_second(setting);
    json["seconds"] = {{"median", seconds.median}, {"shortest", seconds.shortest}, {"longest", seconds.longest}};
    json["frames"] = frames_json(setting);
    json["profile"] = setting.profile ? to_json(*setting.profile) : Json();
    return json;
}

/// A run's JSON with a table of launches that does not outgrow a page.
Json timeline_json(const Sweep& sweep) {
    if (!sweep.timeline) return nullptr;
    RunProfile run = *sweep.timeline;
    const std::size_t launches = run.frame.launches.size();
    run.frame.launches.resize(std::min(launches, kept_launches));
    run.frame.waves.resize(std::min(run.frame.waves.size(), kept_launches));
    return {{"setting", sweep.timeline_setting},
            {"launches_left_out", launches - run.frame.launches.size()},
            {"profile", to_json(run)}};
}

}  // namespace

Json to_json(const Sweep& sweep) {
    Json settings = Json::array();
    for (const SweepSetting& setting : sweep.settings) settings.push_back(setting_json(setting, sweep.repeats));
    return {{"format", format_version},        {"version", sweep.version},       {"complete", sweep.complete},
            {"seconds", sweep.seconds},        {"repeats", sweep.repeats},       {"scene", scene_json(sweep)},
            {"device", device_json(sweep)},    {"finding", finding_json(sweep)}, {"settings", std::move(settings)},
            {"timeline", timeline_json(sweep)}};
}

}  // namespace raymill::profile
