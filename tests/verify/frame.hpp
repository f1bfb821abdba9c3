// A scene on a device, ready to be verified or explained.
#pragma once

#include <memory>
#include <string>

#include "bvh/bvh.hpp"
#include "scene/scene.hpp"
#include "verify/film_ledger.hpp"
#include "verify/verifier.hpp"

namespace raymill::verify {

/// tests/verify/branching.toml.
Scene branching_scene();

/// Device, hierarchy and renderer of a scene. The renderer keeps what the ledger asks for.
struct TestFrame {
    explicit TestFrame(Scene scene, const std::string& kernel_dir = {}, std::uint64_t queue_capacity = 256);

    Scene scene;
    Device device;
    Bvh bvh;
    Renderer renderer;
};

/// The report of one stage.
const StageReport& report_of(const std::vector<StageReport>& reports, const std::string& stage);

}  // namespace raymill::verify
