#include <gtest/gtest.h>

#include "measure.hpp"
#include "scaling.hpp"

namespace raymill::bench {

namespace {

SetResult set_of(const char* name, double automatic, double packet) {
    SetResult set;
    set.name = name;
    set.variants = {{AUTOMATIC, true, {}, {automatic, automatic, automatic}, 0},
                    {"raymill packet", true, {}, {packet, packet, packet}, 0},
                    {"embree 1 coherent", false, {}, {1, 1, 1}, 0}};
    return set;
}

SceneResult scene_of(const char* name, std::vector<SetResult> sets) {
    SceneResult scene;
    scene.name = name;
    scene.sets = std::move(sets);
    return scene;
}

}  // namespace

TEST(Summary, takes_the_renderers_own_choice_over_all_scenes) {
    const auto summaries = summarise({scene_of("hall", {set_of("P", 2, 5), set_of("D", 1, 1)}),
                                      scene_of("scan", {set_of("P", 0.5, 6), set_of("D", 4, 1)})});
    ASSERT_EQ(summaries.size(), 2u);
    EXPECT_EQ(summaries[0].set, "P");
    // The logarithms' rounding.
    EXPECT_NEAR(summaries[0].geometric_mean, 1, 1e-14);
    EXPECT_EQ(summaries[0].worst, 0.5);
    EXPECT_EQ(summaries[0].worst_scene, "scan");
    EXPECT_EQ(summaries[1].set, "D");
    EXPECT_NEAR(summaries[1].geometric_mean, 2, 1e-14);
    EXPECT_EQ(summaries[1].worst, 1);
    EXPECT_EQ(summaries[1].worst_scene, "hall");
}

TEST(Summary, says_nothing_of_sets_that_only_others_traced) {
    SetResult set = set_of("P", 2, 5);
    set.variants.erase(set.variants.begin());
    EXPECT_TRUE(summarise({scene_of("hall", {set})}).empty());
}

TEST(Summary, finds_the_largest_difference_of_any_variant) {
    SceneResult scene = scene_of("hall", {set_of("P", 1, 1), set_of("S", 1, 1)});
    scene.sets[1].variants[1].differing = 0.25;
    EXPECT_EQ(scene.worst_difference(), 0.25);
}

TEST(MeasureOptions, want_all_sets_or_those_named) {
    MeasureOptions options;
    EXPECT_TRUE(options.wants("P"));
    options.sets = {"S", "A"};
    EXPECT_FALSE(options.wants("P"));
    EXPECT_TRUE(options.wants("A"));
}

TEST(ScalingTable, wants_growth_below_and_speed_up_above_its_limit) {
    const ScalingRow row{"P", {1, 2}, 2};
    EXPECT_TRUE((ScalingTable{"", {}, "growth", 4, false, {}}.keeps_limit(row)));
    EXPECT_FALSE((ScalingTable{"", {}, "growth", 1.5, false, {}}.keeps_limit(row)));
    EXPECT_TRUE((ScalingTable{"", {}, "speed-up", 1.9, true, {}}.keeps_limit(row)));
    EXPECT_FALSE((ScalingTable{"", {}, "speed-up", 3.8, true, {}}.keeps_limit(row)));
}

}  // namespace raymill::bench
