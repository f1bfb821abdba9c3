// What was measured, as a table and as JSON.
#pragma once

#include <string>
#include <vector>

#include "measure.hpp"
#include "scaling.hpp"

namespace raymill::bench {

/// Where and how it was measured.
struct Circumstances {
    std::string device;
    std::string driver;
    unsigned compute_units = 0;
    std::string embree;  // version
    MeasureOptions options;
};

/// To standard output.
void print_heading(const Circumstances& circumstances);
void print_scene(const SceneResult& scene);
/// A row that does not keep the limit is marked.
void print_scaling(const ScalingTable& table);

/// Our variants' ratio to Embree's best: a line a scene and set, then a line a set over all scenes.
void print_summary(const std::vector<SceneResult>& scenes);

/// Either may be empty. Throws OutputError if the file cannot be written.
void write_json(const std::string& file, const Circumstances& circumstances, const std::vector<SceneResult>& scenes,
                const std::vector<ScalingTable>& scaling);

}  // namespace raymill::bench
