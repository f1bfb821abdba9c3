#include "profile/json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace raymill::profile {

using Json = nlohmann::ordered_json;

namespace {

constexpr int format_version = 1;

double seconds_since(std::int64_t start, std::int64_t time) {
    return 1e-9 * static_cast<double>(time - start);
}

Json settings_json(const RunProfile& run) {
    return {{"scene", run.scene},
            {"width", run.width},
            {"height", run.height},
            {"samples_per_pixel", run.samples_per_pixel},
            {"primitives", run.primitives},
            {"device", run.device},
            {"compute_units", run.compute_units},
            {"queue_capacity", run.queue_capacity},
            {"work_group", run.work_group},
            {"device_bytes", run.device_bytes},
            {"film_hash", fmt::format("{:016x}", run.film_hash)}};
}

Json times_json(const RunProfile& run) {
    Json spans = Json::array();
    for (const Span& span : run.spans)
        spans.push_back(
            {{"name", span.name}, {"start", seconds_since(run.start, span.start)}, {"seconds", span.seconds()}});
    const FrameTimes& times = run.frame.times;
    return {{"wall", run.seconds},
            {"not_measured", run.unaccounted()},
            {"spans", spans},
            {"frame",
             {{"seconds", times.seconds},
              {"kernels", times.kernels},
              {"first_launches", times.first_launches},
              {"launching", times.launching},
              {"host", times.host}}}};
}

Json kernels_json(const KernelCache& cache) {
    if (!cache.known) return nullptr;
    return {{"built", cache.built}, {"from_cache", cache.from_cache}};
}

Json fates_json(const Fates& fates) {
    return {{"missed", fates.missed},         {"absorbed", fates.absorbed},   {"depth_limit", fates.depth_limit},
            {"weightless", fates.weightless}, {"one_child", fates.one_child}, {"two_children", fates.two_children}};
}

Json stage_json(const StageTotal& total) {
    return {{"launches", total.launches},
            {"items_in", total.items_in},
            {"items_out", total.items_out},
            {"capacity", total.capacity},
            {"high_water", total.high_water},
            {"work_items", total.work_items},
            {"groups", total.groups},
            {"places", total.places},
            {"fullness", total.fullness()},
            {"seconds", total.seconds},
            {"shortest", total.shortest},
            {"longest", total.longest},
            {"bytes_read", total.traffic.bytes_read},
            {"bytes_written", total.traffic.bytes_written},
            {"atomics", total.traffic.atomics}};
}

Json stages_json(const FrameProfile& frame) {
    Json stages = Json::array();
    for (std::size_t i = 0; i < stage_count; ++i) {
        const StageTotal total = frame.total(static_cast<Stage>(i));
        if (total.launches == 0) continue;
        Json entry = {{"stage", stage_name(total.stage)}};
        entry.update(stage_json(total));
        entry["depths"] = Json::array();
        for (const StageTotal& one : frame.stages)
            if (one.stage == total.stage && one.depth != no_depth) {
                Json depth = {{"depth", one.depth}};
                depth.update(stage_json(one));
                entry["depths"].push_back(std::move(depth));
            }
        stages.push_back(std::move(entry));
    }
    return stages;
}

Json depths_json(const FrameProfile& frame) {
    Json depths = Json::array();
    for (const DepthTotal& depth : frame.depths)
        depths.push_back({{"depth", depth.depth},
                          {"capacity", depth.capacity},
                          {"high_water", depth.high_water},
                          {"pushed", depth.pushed},
                          {"popped", depth.popped},
                          {"waves", depth.waves},
                          {"fates", fates_json(depth.fates)},
                          {"shadow_rays", depth.shadow_rays},
                          {"shadow_blocked", depth.shadow_blocked}});
    return depths;
}

// Long lists are rows of numbers under one line of column names: keys in every entry would be most of the file.

Json waves_json(const FrameProfile& frame) {
    Json rows = Json::array();
    for (const Wave& w : frame.waves)
        rows.push_back({w.depth, w.rays, w.fates.missed, w.fates.absorbed, w.fates.depth_limit, w.fates.weightless,
                        w.fates.one_child, w.fates.two_children, w.shadow_rays, w.shadow_blocked});
    return {{"columns",
             {"depth", "rays", "missed", "absorbed", "depth_limit", "weightless", "one_child", "two_children",
              "shadow_rays", "shadow_blocked"}},
            {"rows", std::move(rows)}};
}

Json launches_json(const RunProfile& run) {
    const auto time = [&](std::int64_t t) { return seconds_since(run.start, t); };
    const auto belongs = [](const Launch& l) { return l.wave != no_wave; };
    Json rows = Json::array();
    for (const Launch& l : run.frame.launches)
        rows.push_back({stage_name(l.stage), belongs(l) ? Json(l.depth) : Json(), belongs(l) ? Json(l.wave) : Json(),
                        l.items_in, l.items_out, l.work_items, l.groups, l.places, l.traffic.bytes_read,
                        l.traffic.bytes_written, l.traffic.atomics, time(l.queued), time(l.submitted), time(l.started),
                        time(l.ended)});
    return {{"columns",
             {"stage", "depth", "wave", "items_in", "items_out", "work_items", "groups", "places", "bytes_read",
              "bytes_written", "atomics", "queued", "submitted", "started", "ended"}},
            {"rows", std::move(rows)}};
}

}  // namespace

Json to_json(const RunProfile& run) {
    Json json = {{"format", format_version},         {"run", settings_json(run)},
                 {"times", times_json(run)},         {"compiled_kernels", kernels_json(run.kernel_cache)},
                 {"stages", stages_json(run.frame)}, {"depths", depths_json(run.frame)}};
    if (run.frame.detail == Detail::launches) {
        json["waves"] = waves_json(run.frame);
        json["launches"] = launches_json(run);
    }
    return json;
}

}  // namespace raymill::profile
