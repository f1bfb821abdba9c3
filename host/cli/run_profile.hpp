// The profile of a whole run: what a frame's profile cannot know of scene, device, settings and the rest of the
// program.
#pragma once

#include <filesystem>

#include "bvh/bvh.hpp"
#include "profile/timeline.hpp"
#include "wavefront/renderer.hpp"

namespace raymill {

/// Stands at the beginning of what is to be profiled.
class RunClock {
  public:
    profile::Timeline timeline;

    /// Everything about the run until now. Takes over the frame's profile.
    profile::RunProfile read(const Scene& scene, const Device& device, const RenderOptions& options,
                             const Renderer& renderer, Frame& frame);

  private:
    std::int64_t start_ = profile::now();
    std::filesystem::file_time_type file_time_ = std::filesystem::file_time_type::clock::now();
};

/// The file holds the run as JSON, or as a trace, or stays as it was. Throws OutputError.
void write_statistics(const std::string& file, const profile::RunProfile& run);
void write_trace(const std::string& file, const profile::RunProfile& run);

}  // namespace raymill
