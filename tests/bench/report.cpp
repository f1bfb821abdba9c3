#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace raymill::bench {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Quartiles& q) {
    return {{"median", q.median}, {"lower_quartile", q.lower}, {"upper_quartile", q.upper}};
}

Json json_of(const BuildResult& build) {
    return {{"name", build.name},
            {"mprimitives_per_second", json_of(build.mprimitives)},
            {"bytes_per_primitive", build.bytes_a_primitive}};
}

Json json_of(const SetResult& set) {
    Json variants = Json::array();
    for (const VariantResult& v : set.variants)
        variants.push_back({{"name", v.name},
                            {"ours", v.ours},
                            {"mrays_per_second", json_of(v.mrays)},
                            {"ratio_to_best_embree", json_of(v.ratio)},
                            {"differing", v.differing}});
    return {{"set", set.name},        {"description", set.description}, {"rays", set.rays},
            {"hitting", set.hitting}, {"best_embree", set.best},        {"variants", variants}};
}

Json json_of(const SceneResult& scene) {
    Json sets = Json::array();
    for (const SetResult& set : scene.sets) sets.push_back(json_of(set));
    Json builds = Json::array();
    for (const BuildResult& build : scene.builds) builds.push_back(json_of(build));
    return {{"scene", scene.name},
            {"triangles", scene.triangles},
            {"spheres", scene.spheres},
            {"builds", builds},
            {"depth", scene.statistics.depth},
            {"surface_area_cost", scene.statistics.surface_area_cost},
            {"sets", sets}};
}

Json json_of(const SetSummary& summary) {
    return {{"set", summary.set},
            {"geometric_mean", summary.geometric_mean},
            {"worst", summary.worst},
            {"worst_scene", summary.worst_scene}};
}

Json json_of(const ScalingTable& table) {
    Json rows = Json::array();
    for (const ScalingRow& row : table.rows) {
        rows.push_back({{"name", row.name},
                        {"nanoseconds", row.nanoseconds},
                        {table.factor, row.factor},
                        {"keeps_limit", table.keeps_limit(row)}});
        if (row.embree_factor) rows.back()["embree_" + table.factor] = *row.embree_factor;
    }
    return {{"title", table.title}, {"columns", table.columns}, {"limit", table.limit}, {"rows", rows}};
}

void print_build(const BuildResult& build) {
    fmt::print("  build {:<13} {:7.2f} M/s [{:.2f} {:.2f}]  {:6.1f} bytes a primitive\n", build.name,
               build.mprimitives.median, build.mprimitives.lower, build.mprimitives.upper, build.bytes_a_primitive);
}

}  // namespace

void print_heading(const Circumstances& c) {
    fmt::print("{} ({}), {} compute units, hierarchy {}; Embree {}{}\n", c.device, c.driver, c.compute_units,
               c.options.bvh == BvhQuality::fast ? "fast" : "high", c.embree, c.options.robust ? ", robust" : "");
    fmt::print(
        "P camera, S to a point light, A to an area light, R mirrored, T through glass, D diffuse rays. {} rounds: "
        "median [quartiles], each time the second of two.\nTimes include reading rays and writing hits, of S and A a "
        "byte each. The whole `stage`: as in a frame, unblocked\nlight goes to the film, and rays that miss to the "
        "background.\n",
        c.options.rounds);
}

void print_scene(const SceneResult& scene) {
    fmt::print("\n{}: {} triangles, {} spheres; depth {}, cost {:.1f}\n", scene.name, scene.triangles, scene.spheres,
               scene.statistics.depth, scene.statistics.surface_area_cost);
    for (const BuildResult& build : scene.builds) print_build(build);
    for (const SetResult& set : scene.sets) {
        fmt::print("  {}: {} {}, {:.1f} % {}\n", set.name, set.rays, set.description, 100 * set.hitting,
                   set.any_hit ? "blocked" : "hit");
        std::size_t widest = 0;
        for (const VariantResult& v : set.variants) widest = std::max(widest, v.name.size());
        for (const VariantResult& v : set.variants)
            fmt::print("    {:<{}} {:7.2f} Mrays/s {:<17}  ratio {:5.2f} {:<13}  differing {:.1e}{}\n", v.name, widest,
                       v.mrays.median, fmt::format("[{:.2f} {:.2f}]", v.mrays.lower, v.mrays.upper), v.ratio.median,
                       fmt::format("[{:.2f} {:.2f}]", v.ratio.lower, v.ratio.upper), v.differing,
                       v.name == set.best ? "  <- Embree's best" : "");
    }
}

void print_scaling(const ScalingTable& table) {
    fmt::print("\n{}, ns; {} {} {}\n  {:<6}", table.title, table.factor, table.at_least ? "at least" : "at most",
               table.limit, "");
    for (const std::string& column : table.columns) fmt::print("{:>10}", column);
    fmt::print("{:>10}\n", table.factor);
    for (const ScalingRow& row : table.rows) {
        fmt::print("  {:<6}", row.name);
        for (const double time : row.nanoseconds) fmt::print("{:>10.1f}", time);
        fmt::print("{:>10.2f}{}{}\n", row.factor,
                   row.embree_factor ? fmt::format("  (Embree {:.2f})", *row.embree_factor) : "",
                   table.keeps_limit(row) ? "" : "  <-");
    }
}

void print_summary(const std::vector<SceneResult>& scenes) {
    fmt::print("\nratio to Embree's best\n");
    for (const SceneResult& scene : scenes)
        for (const SetResult& set : scene.sets) {
            std::string line = fmt::format("  {:<12} {}", scene.name, set.name);
            for (const VariantResult& v : set.variants)
                if (v.ours) line += fmt::format("  {} {:5.2f}", v.name, v.ratio.median);
            fmt::print("{}\n", line);
        }
    fmt::print("\nratio of {} to Embree's best, over {} scenes\n", AUTOMATIC, scenes.size());
    for (const SetSummary& set : summarise(scenes))
        fmt::print("  {}  geometric mean {:5.2f}, worst {:5.2f} ({})\n", set.set, set.geometric_mean, set.worst,
                   set.worst_scene);
}

void write_json(const std::string& file, const Circumstances& c, const std::vector<SceneResult>& scenes,
                const std::vector<ScalingTable>& scaling) {
    Json all = {{"device", c.device},
                {"driver", c.driver},
                {"compute_units", c.compute_units},
                {"embree", c.embree},
                {"embree_robust", c.options.robust},
                {"width", c.options.width},
                {"height", c.options.height},
                {"rounds", c.options.rounds},
                {"builds", c.options.builds},
                {"bvh", c.options.bvh == BvhQuality::fast ? "fast" : "high"},
                {"threads", c.options.threads},
                {"clock", c.options.clock == Clock::wall ? "wall" : "processor"},
                {"summary", Json::array()},
                {"scenes", Json::array()},
                {"scaling", Json::array()}};
    for (const SetSummary& set : summarise(scenes)) all["summary"].push_back(json_of(set));
    for (const SceneResult& scene : scenes) all["scenes"].push_back(json_of(scene));
    for (const ScalingTable& table : scaling) all["scaling"].push_back(json_of(table));
    std::ofstream out(file);
    out << all.dump(2) << '\n';
    out.close();
    if (!out) throw OutputError(fmt::format("cannot write {}: {}", file, std::strerror(errno)));
}

}  // namespace raymill::bench
