#include "measure.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

namespace raymill::bench {

namespace {

/// Workers of the one side that still look for work would take a core from the other.
constexpr std::chrono::milliseconds pause_between{2};

double seconds_of(const std::function<void()>& work) {
    std::this_thread::sleep_for(pause_between);
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    return took.count();
}

double share_differing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::size_t differing = 0;
    for (std::size_t i = 0; i < a.size(); ++i) differing += a[i] != b[i];
    return a.empty() ? 0 : static_cast<double>(differing) / static_cast<double>(a.size());
}

/// What the variants find, and by how much.
struct Comparison {
    std::vector<double> differing;  // by variant: share of rays that it does not agree on with rtcIntersect1
    double hitting = 0;
};

/// Traces with every variant once, which also compiles kernels and wakes threads.
Comparison compare(const std::vector<Variant>& variants, bool any_hit) {
    std::vector<std::vector<std::uint32_t>> found;
    for (const Variant& variant : variants) {
        variant.trace();
        found.push_back(variant.found());
    }
    const auto single = std::find_if(variants.begin(), variants.end(), [](const Variant& v) { return !v.ours; });
    const std::vector<std::uint32_t>& reference = found[static_cast<std::size_t>(single - variants.begin())];
    Comparison comparison;
    for (const auto& ids : found) comparison.differing.push_back(share_differing(ids, reference));
    const auto missing = std::count(reference.begin(), reference.end(), any_hit ? 0u : NO_INDEX);
    comparison.hitting = 1 - static_cast<double>(missing) / static_cast<double>(reference.size());
    return comparison;
}

/// Seconds by variant and round.
std::vector<std::vector<double>> time_rounds(const std::vector<Variant>& variants, int rounds) {
    std::vector<std::vector<double>> seconds(variants.size());
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < variants.size(); ++i) seconds[i].push_back(seconds_of(variants[i].trace));
    return seconds;
}

std::size_t best_of_embree(const std::vector<Variant>& variants, const std::vector<std::vector<double>>& seconds) {
    std::size_t best = variants.size();
    for (std::size_t i = 0; i < variants.size(); ++i)
        if (!variants[i].ours &&
            (best == variants.size() || quartiles(seconds[i]).median < quartiles(seconds[best]).median))
            best = i;
    return best;
}

SetResult measure_set(const RaySet& set, RaymillSide& ours, const EmbreeSide& embree, int rounds) {
    SetResult result{set.name, set.description, set.any_hit, set.rays.size(), 0, {}, {}};
    if (set.rays.empty()) return result;
    std::vector<Variant> variants = ours.variants(set);
    for (Variant& variant : embree.variants(set)) variants.push_back(std::move(variant));
    const Comparison comparison = compare(variants, set.any_hit);
    result.hitting = comparison.hitting;
    const std::vector<std::vector<double>> seconds = time_rounds(variants, rounds);
    const std::size_t best = best_of_embree(variants, seconds);
    result.best = variants[best].name;
    for (std::size_t i = 0; i < variants.size(); ++i) {
        std::vector<double> mrays, ratios;
        for (std::size_t round = 0; round < seconds[i].size(); ++round) {
            mrays.push_back(static_cast<double>(set.rays.size()) * 1e-6 / seconds[i][round]);
            ratios.push_back(seconds[best][round] / seconds[i][round]);
        }
        result.variants.push_back(
            {variants[i].name, variants[i].ours, quartiles(mrays), quartiles(ratios), comparison.differing[i]});
    }
    return result;
}

BuildResult build_result(const char* name, const std::vector<Build>& builds, std::size_t primitives) {
    std::vector<double> rates;
    for (const Build& build : builds) rates.push_back(static_cast<double>(primitives) * 1e-6 / build.seconds);
    return {name, quartiles(rates), static_cast<double>(builds.back().bytes) / static_cast<double>(primitives)};
}

}  // namespace

double SceneResult::worst_difference() const {
    double worst = 0;
    for (const SetResult& set : sets)
        for (const VariantResult& variant : set.variants) worst = std::max(worst, variant.differing);
    return worst;
}

SceneResult measure(const BenchScene& bench, const RaymillKernels& kernels, const MeasureOptions& options) {
    const Scene& scene = bench.scene;
    RaymillHierarchy fast(scene, {options.threads, BvhQuality::fast}), high(scene, {options.threads, BvhQuality::high});
    EmbreeSide medium(scene, options.threads, RTC_BUILD_QUALITY_MEDIUM, options.robust);
    EmbreeSide embree_high(scene, options.threads, RTC_BUILD_QUALITY_HIGH, options.robust);
    std::vector<Build> builds[4];
    for (int i = 0; i < options.builds; ++i) {
        builds[0].push_back(fast.build());
        builds[1].push_back(medium.build());
        builds[2].push_back(high.build());
        builds[3].push_back(embree_high.build());
    }
    SceneResult result{bench.name, scene.triangles.size(), scene.spheres.size(), {}, {}, {}};
    const char* const names[] = {"raymill fast", "embree medium", "raymill high", "embree high"};
    for (int i = 0; i < 4; ++i)
        result.builds.push_back(build_result(names[i], builds[i], result.triangles + result.spheres));
    const bool is_fast = options.bvh == BvhQuality::fast;
    const RaymillHierarchy& hierarchy = is_fast ? fast : high;
    const EmbreeSide& embree = is_fast ? medium : embree_high;
    result.statistics = hierarchy.bvh().statistics;

    RaymillSide side(kernels, scene, hierarchy.bvh());
    const RaySet camera = camera_rays(scene.camera, options.width, options.height);
    result.sets.push_back(measure_set(camera, side, embree, options.rounds));
    for (const RaySet& set : bounced_rays(bench, camera, embree.closest_hits(camera.rays)))
        result.sets.push_back(measure_set(set, side, embree, options.rounds));
    return result;
}

}  // namespace raymill::bench
