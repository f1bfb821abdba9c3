// Kernels with one mistake each: verify must find it, and in the right stage.
#include <gtest/gtest.h>

#include "frame.hpp"
#include "support/changed_kernels.hpp"

namespace raymill::verify {
namespace {

struct PlantedBug {
    const char* name;
    const char* file;
    const char* right;
    const char* wrong;
    const char* stage;
};

void PrintTo(const PlantedBug& bug, std::ostream* out) {
    *out << bug.name;
}

const PlantedBug bugs[] = {
    {"pixel_offset", "lib/camera.h", "(row + jitter_y)", "(row + jitter_x)", "generate"},
    {"wrong_triangle_weight", "lib/triangle.h", "*u = va * inverse", "*u = wa * inverse", "intersect"},
    {"far_end_of_spheres", "lib/sphere.h", "near = min8(t0, t1)", "near = max8(t0, t1)", "intersect"},
    {"no_attenuation", "lib/light.h", "attenuation = 1.0f / fma(", "attenuation = 1.0f + 0.0f * fma(", "shade"},
    {"attenuation_off_by_1e_5", "lib/light.h", "attenuation = 1.0f / fma(", "attenuation = 1.00001f / fma(", "shade"},
    {"no_offset", "lib/surface.h", "if (!world->constants->robust_offset) return s->position;", "return s->position;",
     "shade"},
    {"no_coverage", "shade.cl", "s->hits.route == ROUTE_CAMERA", "s->hits.route != ROUTE_CAMERA", "shade"},
    {"coverage_of_all_routes", "shade.cl", "lane_mask16(s->hits.route == ROUTE_CAMERA) & terms.lanes", "terms.lanes",
     "film"},
    {"filter_without_transmission", "lib/transmittance.h", " * material->transmission", "", "shadow"},
    {"mirrored_sign", "lib/material.h", "lanes_fma(-2.0f * lanes_dot(direction, n), n, direction)",
     "lanes_fma(2.0f * lanes_dot(direction, n), n, direction)", "secondary"},
    {"inverse_index", "lib/material.h", "lanes_div(lanes_fma(-cosine, n, direction), eta)",
     "lanes_scale(lanes_fma(-cosine, n, direction), eta)", "secondary"},
    {"half_of_fresnel", "lib/material.h", "reflectance = 0.5f * (parallel", "reflectance = 0.25f * (parallel",
     "secondary"},
    {"children_share_a_path", "secondary.cl", "path_child(hits->path, branch)", "path_child(hits->path, 0)",
     "secondary"},
    {"green_counted_as_red", "lib/film.h", "first.part[i] + second.part[i];",
     "(first.part[i] + second.part[i]).s0023446788abccef;", "film"},
};

class Planted : public testing::TestWithParam<PlantedBug> {};

TEST_P(Planted, bug_is_found_in_its_stage) {
    const PlantedBug& bug = GetParam();
    const TemporaryFolder folder;
    change_kernels(folder.path() / "kernels", bug.file, bug.right, bug.wrong);
    if (HasFatalFailure()) return;
    Scene scene = branching_scene();
    scene.camera.aperture = 0;
    TestFrame frame(scene, folder.path() / "kernels");
    const auto reports = verify_frame(frame.device, frame.scene, frame.renderer, {});
    const StageReport& report = report_of(reports, bug.stage);
    EXPECT_GT(report.failures(), 0u);
    EXPECT_NE(report.first_failure(), "");
}

INSTANTIATE_TEST_SUITE_P(Bugs, Planted, testing::ValuesIn(bugs),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace raymill::verify
