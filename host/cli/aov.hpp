// The AOVs of a frame by the names of the command line, as layers of an EXR file.
#pragma once

#include <string>
#include <vector>

#include "image/image.hpp"
#include "wavefront/renderer.hpp"

namespace raymill {

/// Names in a comma-separated list; "all" stands for every one. Throws UsageError that lists them.
std::vector<std::string> parse_aovs(const std::string& list);

/// What the film must keep for these.
FilmPlanes aov_planes(const std::vector<std::string>& names);

/// One layer a name, in the given order.
std::vector<ImageLayer> aov_layers(const Frame& frame, const std::vector<std::string>& names);

}  // namespace raymill
