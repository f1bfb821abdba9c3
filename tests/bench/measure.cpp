#include "measure.hpp"

#include <algorithm>

namespace raymill::bench {

namespace {

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

/// Seconds by variant and round. Each variant traces twice and the second time counts, so that it finds in the caches
/// what it left there itself, not what another one did.
std::vector<std::vector<double>> time_rounds(const std::vector<Variant>& variants, const MeasureOptions& options) {
    std::vector<std::vector<double>> seconds(variants.size());
    for (int round = 0; round < options.rounds; ++round)
        for (std::size_t i = 0; i < variants.size(); ++i) {
            variants[i].trace();
            seconds[i].push_back(seconds_of(variants[i].trace, options.clock));
        }
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

SetResult measure_set(const RaySet& set, RaymillSide& ours, const EmbreeSide& embree, const MeasureOptions& options) {
    SetResult result{set.name, set.description, set.any_hit, set.rays.size(), 0, {}, {}};
    if (set.rays.empty()) return result;
    std::vector<Variant> variants = ours.variants(set);
    for (Variant& variant : embree.variants(set)) variants.push_back(std::move(variant));
    const Comparison comparison = compare(variants, set.any_hit);
    result.hitting = comparison.hitting;
    const std::vector<std::vector<double>> seconds = time_rounds(variants, options);
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

BuildResult build_result(const std::string& name, const std::vector<Build>& builds, std::size_t primitives) {
    std::vector<double> rates;
    for (const Build& build : builds) rates.push_back(static_cast<double>(primitives) * 1e-6 / build.seconds);
    return {name, quartiles(rates), static_cast<double>(builds.back().bytes) / static_cast<double>(primitives)};
}

}  // namespace

SceneResult measure(const BenchScene& bench, const RaymillKernels& kernels, const MeasureOptions& options) {
    const Scene& scene = bench.scene;
    RaymillHierarchy fast(scene, {options.threads, BvhQuality::fast}), high(scene, {options.threads, BvhQuality::high});
    EmbreeSide embree(scene, options.threads, options.robust);
    std::vector<Build> ours_fast, ours_high;
    std::vector<std::vector<Build>> theirs(options.qualities.size());
    for (int i = 0; i < options.builds; ++i) {
        ours_fast.push_back(fast.build());
        ours_high.push_back(high.build());
        for (std::size_t q = 0; q < theirs.size(); ++q) theirs[q].push_back(embree.build(options.qualities[q]));
    }
    SceneResult result{bench.name, scene.triangles.size(), scene.spheres.size(), {}, {}, {}};
    const std::size_t primitives = result.triangles + result.spheres;
    result.builds.push_back(build_result("raymill fast", ours_fast, primitives));
    result.builds.push_back(build_result("raymill high", ours_high, primitives));
    for (std::size_t q = 0; q < theirs.size(); ++q)
        result.builds.push_back(
            build_result(std::string("embree ") + name_of(options.qualities[q]), theirs[q], primitives));
    const RaymillHierarchy& hierarchy = options.bvh == BvhQuality::fast ? fast : high;
    result.statistics = hierarchy.bvh().statistics;

    RaymillSide side(kernels, scene, hierarchy.bvh());
    const RaySet camera = camera_rays(scene.camera, options.width, options.height);
    const auto add = [&](const RaySet& set) {
        if (options.wants(set.name)) result.sets.push_back(measure_set(set, side, embree, options));
    };
    add(camera);
    for (const RaySet& set : bounced_rays(bench, camera, embree.closest_hits(camera.rays))) add(set);
    return result;
}

}  // namespace raymill::bench
