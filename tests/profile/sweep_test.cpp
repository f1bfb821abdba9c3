// What a sweep finds: the best setting, the knee, and whether all images are the same.
#include "profile/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sweep_example.hpp"

namespace raymill::profile {
namespace {

TEST(Spread, of_an_odd_number_of_frames_has_the_middle_one) {
    const Spread s = spread(setting_of(64, 0, {5, 1, 3}));
    EXPECT_EQ(s.median, 3);
    EXPECT_EQ(s.shortest, 1);
    EXPECT_EQ(s.longest, 5);
}

TEST(Spread, of_an_even_number_of_frames_has_the_mean_of_the_middle_two) {
    EXPECT_EQ(spread(setting_of(64, 0, {8, 1, 2, 4})).median, 3);
}

TEST(Spread, of_no_frame_is_zero_and_so_is_the_rate) {
    EXPECT_EQ(spread(setting_of(64, 0, {})).median, 0);
    EXPECT_EQ(rays_per_second(setting_of(64, 0, {})), 0);
}

TEST(Finding, names_the_highest_rate_of_a_median_as_best) {
    Sweep sweep = sweep_example();
    EXPECT_EQ(find(sweep).best, 2u);
    sweep.settings[4].frames = {{1e-6, 0xfeed},
                                {30e-6, 0xfeed}};  // its fastest frame is the fastest, its median is not
    EXPECT_EQ(find(sweep).best, 2u);
    sweep.settings[4].frames[1].seconds = 2e-6;
    EXPECT_EQ(find(sweep).best, 4u);
}

TEST(Finding, puts_the_knee_at_the_smallest_capacity_that_loses_little) {
    const Finding finding = find(sweep_example());
    EXPECT_EQ(finding.knee, 1u);
    EXPECT_EQ(finding.below_knee, 0u);
    EXPECT_NEAR(finding.loss_below_knee, 0.4, 1e-12);  // 60 of 100; a few roundings
}

TEST(Finding, looks_for_the_knee_only_where_all_else_is_as_in_the_best) {
    Sweep sweep = sweep_example();
    sweep.settings.push_back(setting_of(32, 8, {12e-6, 12e-6}));
    sweep.settings.push_back(setting_of(16, 0, {12e-6, 12e-6}));
    sweep.settings.back().threads = 1;
    EXPECT_EQ(find(sweep).knee, 1u);
}

TEST(Finding, loses_below_the_knee_what_the_best_of_the_smaller_ones_loses) {
    Sweep sweep = sweep_example();
    sweep.settings.push_back(setting_of(32, 0, {15e-6, 15e-6}));
    const Finding finding = find(sweep);
    EXPECT_EQ(finding.knee, 1u);
    EXPECT_EQ(finding.below_knee, 0u);
    EXPECT_NEAR(finding.loss_below_knee, 0.2, 1e-12);  // 80 of 100; a few roundings
}

TEST(Finding, takes_a_setting_for_as_good_that_was_once_faster_than_the_bests_median) {
    Sweep sweep = sweep_example();
    EXPECT_TRUE(find(sweep).as_good.empty());
    sweep.settings[0].frames[0].seconds = 11.9e-6;
    const Finding finding = find(sweep);
    EXPECT_EQ(finding.as_good, std::vector<std::size_t>{0});
    EXPECT_EQ(finding.knee, 0u) << "what cannot be told from the best is on its plateau";
    EXPECT_FALSE(finding.below_knee);
}

TEST(Finding, of_equal_hashes_is_the_same_image) {
    const Finding finding = find(sweep_example());
    EXPECT_TRUE(finding.same_image());
    EXPECT_EQ(finding.film_hash, 0xfeedu);
}

TEST(Finding, of_one_falsified_frame_names_its_setting) {
    for (const std::size_t setting : {1u, 2u, 4u}) {
        Sweep sweep = sweep_example();
        sweep.settings[setting].frames[1].film_hash ^= 1;
        const Finding finding = find(sweep);
        EXPECT_EQ(finding.other_image, std::vector<std::size_t>{setting});
        EXPECT_NE(headline(sweep, finding).find("NOT the same"), std::string::npos);
    }
}

TEST(Finding, of_a_falsified_profiled_frame_names_its_setting) {
    Sweep sweep = sweep_example();
    sweep.settings[0].profile->film_hash ^= 1;
    EXPECT_EQ(find(sweep).other_image, std::vector<std::size_t>{0});
}

TEST(Headline, says_best_rate_and_knee) {
    const Sweep sweep = sweep_example();
    EXPECT_EQ(headline(sweep, find(sweep)),
              "Best: 256 rays, work-group auto: 100.00 Mrays/s; the knee is at 128: smaller queues lose 40 %");
}

TEST(Headline, says_threads_where_there_are_several) {
    Sweep sweep = sweep_example();
    sweep.settings[4].threads = 1;
    EXPECT_NE(headline(sweep, find(sweep)).find("work-group auto, 2 threads: 100.00"), std::string::npos);
}

TEST(Headline, says_that_there_is_no_knee) {
    Sweep sweep = sweep_example();
    sweep.settings[0] = setting_of(64, 0, {12.2e-6, 12.2e-6});
    EXPECT_TRUE(headline(sweep, find(sweep)).ends_with("no knee: queues of 64 rays are about as good"));
    sweep.settings[0] = setting_of(64, 0, {6e-6, 6e-6});
    EXPECT_TRUE(headline(sweep, find(sweep)).ends_with("no knee: the smallest queue is the best"));
}

TEST(Headline, of_single_frames_says_how_little_they_tell) {
    Sweep sweep = sweep_example();
    for (SweepSetting& setting : sweep.settings) setting.frames.resize(std::min<std::size_t>(setting.frames.size(), 1));
    EXPECT_TRUE(
        headline(sweep, find(sweep)).ends_with("lose 6 % or more. One frame of each does not tell speed from chance"))
        << headline(sweep, find(sweep));
    sweep.settings = {sweep.settings[2]};
    EXPECT_EQ(headline(sweep, find(sweep)), "Best: 256 rays, work-group auto: 104.35 Mrays/s");
}

TEST(Headline, of_an_interrupted_sweep_says_so_even_if_nothing_was_measured) {
    Sweep sweep = sweep_example();
    sweep.complete = false;
    EXPECT_TRUE(headline(sweep, find(sweep)).starts_with("Interrupted"));
    for (SweepSetting& setting : sweep.settings) setting.frames.clear();
    EXPECT_TRUE(headline(sweep, find(sweep)).ends_with("Nothing was measured."));
}

}  // namespace
}  // namespace raymill::profile
