// The whole frame through the reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "frame.hpp"

namespace raymill::verify {
namespace {

class Settings : public testing::TestWithParam<std::tuple<ShadowMode, ShadowOffset>> {};

TEST_P(Settings, every_item_of_every_kernel_is_within_its_bound) {
    Scene scene = branching_scene();
    std::tie(scene.settings.shadows, scene.settings.shadow_offset) = GetParam();
    TestFrame frame(scene);
    const auto reports = verify_frame(frame.device, frame.scene, frame.renderer, {});
    for (const StageReport& report : reports) {
        EXPECT_EQ(report.failures(), 0u) << report.stage() << "\n" << report.first_failure();
        EXPECT_GT(report.items(), 0u) << report.stage();
        EXPECT_EQ(report.compared(), report.items()) << report.stage();
        EXPECT_LE(report.worst(), 1) << report.stage();
    }
    EXPECT_EQ(report_of(reports, "generate").items(), 24u * 18 * 2);
}

INSTANTIATE_TEST_SUITE_P(All, Settings,
                         testing::Combine(testing::Values(ShadowMode::filtered, ShadowMode::opaque, ShadowMode::none),
                                          testing::Values(ShadowOffset::robust, ShadowOffset::none)));

TEST(Verify, bounds_are_not_far_above_the_errors) {
    TestFrame frame(branching_scene());
    const auto reports = verify_frame(frame.device, frame.scene, frame.renderer, {});
    // A bound that no item comes within a hundredth of would hide mistakes a hundred times the rounding.
    for (const char* stage : {"generate", "intersect", "shade", "shadow", "secondary"})
        EXPECT_GT(report_of(reports, stage).worst(), 0.01) << stage;
}

TEST(Verify, branches_that_rounding_cannot_decide_are_rare) {
    TestFrame frame(branching_scene());
    for (const StageReport& report : verify_frame(frame.device, frame.scene, frame.renderer, {}))
        EXPECT_LE(report.disagreements(), report.items() / 1000) << report.stage();
}

TEST(Verify, beyond_its_budget_it_compares_a_spread_subset) {
    TestFrame frame(branching_scene());
    const auto all = verify_frame(frame.device, frame.scene, frame.renderer, {});
    VerifyOptions options;
    options.primitive_tests = report_of(all, "intersect").items() * frame.scene.primitive_count() / 10;
    const auto some = verify_frame(frame.device, frame.scene, frame.renderer, options);
    const StageReport& report = report_of(some, "intersect");
    EXPECT_EQ(report.items(), report_of(all, "intersect").items());
    // One of every ten; the last block may be cut.
    EXPECT_NEAR(static_cast<double>(report.compared()), static_cast<double>(report.items()) / 10, 2);
    EXPECT_EQ(report_of(some, "shade").compared(), report_of(all, "shade").items());
}

TEST(Verify, an_empty_scene_has_but_camera_rays_and_background) {
    Scene scene;
    scene.materials.emplace_back();
    scene.settings.width = scene.settings.height = 9;
    scene.settings.background = {0.25, 0.5, 1};
    TestFrame frame(scene);
    const auto reports = verify_frame(frame.device, frame.scene, frame.renderer, {});
    for (const StageReport& report : reports) EXPECT_EQ(report.failures(), 0u) << report.first_failure();
    EXPECT_EQ(report_of(reports, "intersect").compared(), 81u);
    EXPECT_EQ(report_of(reports, "shade").items(), 0u);
}

class Gallery : public testing::TestWithParam<std::string> {};

TEST_P(Gallery, a_thumbnail_of_the_scene_is_within_its_bounds) {
    Scene scene = load_scene(RAYMILL_SOURCE_DIR "/scenes/" + GetParam() + ".toml");
    scene.settings.width = 32;
    scene.settings.height = 24;
    scene.settings.spp = 1;
    VerifyOptions options;
    options.primitive_tests = 20'000'000;  // a second or two for each scene
    TestFrame frame(std::move(scene), {}, 1024);
    for (const StageReport& report : verify_frame(frame.device, frame.scene, frame.renderer, options))
        EXPECT_EQ(report.failures(), 0u) << report.stage() << "\n" << report.first_failure();
}

INSTANTIATE_TEST_SUITE_P(Scenes, Gallery, testing::Values("box", "first-light", "glass-and-straw", "hall-of-mirrors"),
                         [](const auto& info) {
                             std::string name = info.param;
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace raymill::verify
