// Runs both sides in turn and compares what they find.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "embree_side.hpp"
#include "profile/statistics.hpp"
#include "profile/stopwatch.hpp"
#include "raymill_side.hpp"

namespace raymill::bench {

using profile::Clock;
using profile::geometric_mean;
using profile::Quartiles;
using profile::quartiles;
using profile::seconds_of;

/// More rays than this share may not find another primitive, or another visibility: rays through edges that two
/// triangles share belong to either, everything else is an error.
inline constexpr double ALLOWED_DIFFERENCE = 1e-3;

struct VariantResult {
    std::string name;
    bool ours = false;
    Quartiles mrays;       // millions of rays a second
    Quartiles ratio;       // to Embree's best variant, round by round
    double differing = 0;  // share of rays whose result is not that of Embree's calls of one ray
};

struct SetResult {
    std::string name;
    std::string description;
    bool any_hit = false;
    std::size_t rays = 0;
    double hitting = 0;  // share of rays that hit something, or are blocked
    std::string best;    // Embree's variant of the highest median
    std::vector<VariantResult> variants;
};

struct BuildResult {
    std::string name;
    Quartiles mprimitives;  // millions of triangles and spheres a second
    double bytes_a_primitive = 0;
};

struct SceneResult {
    std::string name;
    std::size_t triangles = 0;
    std::size_t spheres = 0;
    std::vector<BuildResult> builds;  // ours and Embree's by quality
    BvhStatistics statistics;
    std::vector<SetResult> sets;

    /// The largest share of differing results among all variants.
    double worst_difference() const;
};

struct MeasureOptions {
    int width = 1024;  // of the camera's image, multiples of TILE
    int height = 768;
    int rounds = 11;
    int builds = 3;
    unsigned threads = 0;  // 0: all
    Clock clock = Clock::wall;
    BvhQuality bvh = BvhQuality::high;                                  // of our hierarchy
    bool robust = false;                                                // Embree's watertight mode
    std::vector<Quality> qualities = {Quality::medium, Quality::high};  // of Embree's hierarchies, at least one
    std::vector<std::string> sets;                                      // names of those to trace; empty: all

    bool wants(const std::string& set) const { return sets.empty() || std::ranges::find(sets, set) != sets.end(); }
};

/// A set's ratio of what the renderer chooses by itself to Embree's best, over scenes.
struct SetSummary {
    std::string set;
    double geometric_mean = 0;
    double worst = 0;
    std::string worst_scene;
};

/// One a set, in the order in which they first occur, of the medians of the variant AUTOMATIC; nothing of sets in which
/// it did not run.
std::vector<SetSummary> summarise(const std::vector<SceneResult>& scenes);

/// Builds all hierarchies `builds` times in turn, then measures each set of rays: one trace of every variant to
/// compare the results, and `rounds` rounds in which each variant runs once.
SceneResult measure(const BenchScene& bench, const RaymillKernels& kernels, const MeasureOptions& options);

}  // namespace raymill::bench
