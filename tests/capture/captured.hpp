// A frame of tests/verify/branching.toml, and one of its launches.
#pragma once

#include "capture/recorder.hpp"
#include "frame.hpp"

namespace raymill::capture {

using profile::Stage;
using verify::branching_scene;
using verify::TestFrame;

/// What a launch of the frame wrote, read out of the frame's own queues.
struct Written {
    std::vector<Ray> rays;  // generate, secondary
    std::vector<Hit> hits;
    std::vector<ShadowRay> shadow_rays;  // packed
    std::vector<uint> shadow_counts;
};

/// Renders the frame and takes out a launch: the fullest, unless one is named. written: what it wrote there.
Capture capture_of(TestFrame& frame, Stage stage, int depth, std::optional<std::uint64_t> launch = {},
                   Written* written = nullptr);

/// What a stage wrote, at the moment when an observer sees it.
Written read_written(const Device& device, Stage stage, const WaveView& view);

/// All bytes of each item.
template <class T>
std::vector<std::string> bytes_of(const std::vector<T>& items) {
    std::vector<std::string> bytes;
    for (const T& item : items) bytes.emplace_back(reinterpret_cast<const char*>(&item), sizeof item);
    return bytes;
}

/// "shade" for tests named after stages.
inline std::string name_of(Stage stage) {
    return std::string(profile::stage_name(stage));
}

}  // namespace raymill::capture
