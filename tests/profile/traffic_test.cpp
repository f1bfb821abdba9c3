// Bytes and atomics that follow from the counts, by hand: a Ray has 52 bytes, a Hit 16, a ShadowRay 64.
#include <gtest/gtest.h>

#include "run_example.hpp"

namespace raymill::profile {
namespace {

TEST(Fates, add_up_to_rays_hits_and_children) {
    const Fates fates{30, 15, 7, 5, 40, 10};
    EXPECT_EQ(fates.rays(), 107u);
    EXPECT_EQ(fates.hits(), 77u);
    EXPECT_EQ(fates.children(), 60u);
}

TEST(FrameProfile, adds_up_over_depths) {
    const FrameProfile frame = run_example().frame;
    EXPECT_EQ(frame.total(Stage::intersect).items_in, 160u);
    EXPECT_EQ(frame.total(Stage::intersect).launches, 2u);
    EXPECT_EQ(frame.total(Stage::features).launches, 0u);
    EXPECT_EQ(frame.fates(), (Fates{90, 15, 0, 5, 40, 10}));
    EXPECT_EQ(frame.rays(), 160u);
    EXPECT_EQ(frame.shadow_rays(), 140u);
    EXPECT_EQ(frame.shadow_blocked(), 15u);
    EXPECT_DOUBLE_EQ(frame.total(Stage::intersect).fullness(), 160.0 / 192.0);  // the same division
}

TEST(Traffic, counts_each_item_for_every_launch_that_moves_it) {
    const FrameProfile frame = run_example().frame;
    const auto expect = [&](Stage stage, std::uint64_t read, std::uint64_t written) {
        EXPECT_EQ(traffic(frame, stage).bytes_read, read) << stage_name(stage);
        EXPECT_EQ(traffic(frame, stage).bytes_written, written) << stage_name(stage);
    };
    expect(Stage::generate, 0, 100 * 52);
    expect(Stage::intersect, 160 * 52, 160 * 16);
    expect(Stage::shade, 200 * 16 + 140 * 52, 140 * 64 + 4 * 4);  // two passes over 70 hits; four segments
    expect(Stage::shadow, 140 * 64 + 4 * 4, 0);
    expect(Stage::secondary, 100 * 16 + 55 * 52, 60 * 52);  // 55 hits may have children
    expect(Stage::resolve, 400 * 8, 400 * 4);
    expect(Stage::features, 0, 0);
}

TEST(Traffic, bounds_atomics_by_the_planes_that_are_kept) {
    FrameProfile frame = run_example().frame;
    EXPECT_EQ(traffic(frame, Stage::intersect).atomics_at_most, 70u + 90 * 3);
    EXPECT_EQ(traffic(frame, Stage::shadow).atomics_at_most, 125u * 6 + 2 * 4);
    frame.film_adds = {6, 4, 0, 0};
    EXPECT_EQ(traffic(frame, Stage::intersect).atomics_at_most, 70u + 90 * 6);
    EXPECT_EQ(traffic(frame, Stage::shadow).atomics_at_most, 125u * 12 + 140 * 4 + 2 * 4);
    EXPECT_EQ(traffic(frame, Stage::generate).atomics_at_most, 0u);
}

}  // namespace
}  // namespace raymill::profile
