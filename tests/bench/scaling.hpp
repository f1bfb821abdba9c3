// How the time of a ray grows with the scene, with threads, and with the sizes of queues and images.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "measure.hpp"
#include "scenes.hpp"

namespace raymill::bench {

struct ScalingRow {
    std::string name;
    std::vector<double> nanoseconds;  // a ray, medians, by column
    double factor = 1;
    std::optional<double> embree_factor{};  // the same of Embree's fastest calls, where measured
};

/// One question: its rows are measured alike, and their factors are to keep a limit.
struct ScalingTable {
    std::string title;
    std::vector<std::string> columns;
    std::string factor;  // what it is, for example "growth"
    double limit = 1;
    bool at_least = false;  // the factor must not be below the limit; else not above it
    std::vector<ScalingRow> rows;

    bool keeps_limit(const ScalingRow& row) const { return at_least ? row.factor >= limit : row.factor <= limit; }
};

// The limits.
inline constexpr double LARGEST_GROWTH = 4;        // of a ray's time, from 10k triangles to the largest scene
inline constexpr double SMALLEST_SPEED_UP = 0.95;  // times the number of threads
/// Of three neighbouring sizes, the slowest over the fastest: medians of frames alike scatter by less on an idle
/// machine.
inline constexpr double LARGEST_STEP = 1.15;

struct ScalingOptions {
    MeasureOptions measure;
    std::string device;
    double largest = 1e7;  // triangles, at least 10k
};

/// Answers all questions for one made scene, each table handed over as soon as it is there:
///   scene    10k triangles, ten times as many, ... up to the largest; our automatic choice, each set of rays;
///            all scenes are held at once, to be traced in turn; of Embree the growth from the first to the last
///   threads  1, 2, 4 ... up to all, by the wall clock; not where there is but one
///   queue    frames of one light and one reflection, queue capacities 2^k - 1, 2^k, 2^k + 1, and the default
///   image    the same frames, square, as wide, up to twice the measured image
/// The last three with up to a million triangles.
void measure_scaling(const Recipe& recipe, const ScalingOptions& options,
                     const std::function<void(const ScalingTable&)>& done);

}  // namespace raymill::bench
