#include "frame.hpp"

#include <algorithm>
#include <stdexcept>

namespace raymill::verify {

namespace {

RenderOptions options_for(const std::string& kernel_dir, std::uint64_t queue_capacity) {
    RenderOptions options;
    options.planes = ledger_planes();
    options.kernel_dir = kernel_dir;
    options.memory.queue_capacity = queue_capacity;
    return options;
}

}  // namespace

Scene branching_scene() {
    return load_scene(RAYMILL_SOURCE_DIR "/tests/verify/branching.toml");
}

TestFrame::TestFrame(Scene the_scene, const std::string& kernel_dir, std::uint64_t queue_capacity)
    : scene(std::move(the_scene)),
      device(open_device("", 0)),
      bvh(build_bvh(scene.vertices, scene.triangles, scene.spheres)),
      renderer(device, scene, bvh, options_for(kernel_dir, queue_capacity)) {}

const StageReport& report_of(const std::vector<StageReport>& reports, const std::string& stage) {
    const auto found = std::ranges::find(reports, stage, &StageReport::stage);
    if (found == reports.end()) throw std::invalid_argument("no stage " + stage);
    return *found;
}

}  // namespace raymill::verify
