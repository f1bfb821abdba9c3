// Totals over launches, and bytes that follow from the counts, by hand: a Ray has 52 bytes, a Hit 16, a ShadowRay 64.
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
        EXPECT_EQ(frame.total(stage).traffic.bytes_read, read) << stage_name(stage);
        EXPECT_EQ(frame.total(stage).traffic.bytes_written, written) << stage_name(stage);
    };
    expect(Stage::generate, 0, 100 * 52);
    expect(Stage::intersect, 160 * 52, 160 * 16);
    expect(Stage::shade, 200 * 16 + 140 * 52, 140 * 64 + 4 * 4);  // two passes over 70 hits; four segments
    expect(Stage::shadow, 140 * 64 + 4 * 4, 0);
    expect(Stage::secondary, 100 * 16 + 55 * 52, 60 * 52);  // 55 hits may have children
    expect(Stage::resolve, 400 * 8, 400 * 4);
    expect(Stage::features, 0, 0);
}

TEST(Traffic, adds_up_over_launches_and_depths) {
    const FrameProfile frame = run_example().frame;
    EXPECT_EQ(frame.total(Stage::intersect).traffic.atomics, 150u + 180);
    EXPECT_EQ(frame.total(Stage::shadow).traffic.atomics, 3u * (60 + 65));
    for (std::size_t i = 0; i < stage_count; ++i) {
        Traffic sum;
        for (const Launch& launch : frame.launches)
            if (launch.stage == static_cast<Stage>(i)) sum += launch.traffic;
        EXPECT_EQ(frame.total(static_cast<Stage>(i)).traffic, sum) << stage_name(static_cast<Stage>(i));
    }
}

TEST(StageTotal, of_launches_has_the_shortest_the_longest_and_the_fullest) {
    Launch launch;
    launch.items_out = 5;
    launch.ended = 3000;
    StageTotal total = total_of(launch, 7);
    launch.items_out = 4;
    launch.ended = 1000;
    total += total_of(launch, 7);
    EXPECT_EQ(total.launches, 2u);
    EXPECT_EQ(total.items_out, 9u);
    EXPECT_EQ(total.high_water, 5u);
    EXPECT_EQ(total.capacity, 7u);
    EXPECT_DOUBLE_EQ(total.shortest, 1e-6);  // one product of doubles
    EXPECT_DOUBLE_EQ(total.longest, 3e-6);
    EXPECT_DOUBLE_EQ(total.seconds, 4e-6);
}

}  // namespace
}  // namespace raymill::profile
