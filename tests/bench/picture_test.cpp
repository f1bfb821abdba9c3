#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "frames/picture.hpp"

namespace raymill::bench {

TEST(PictureDifference, of_a_picture_and_itself_is_nothing) {
    const std::vector<float> picture = {0.5f, 0, 2, 1, 0.25f, 0.25f, 0, 0};
    const PictureDifference d = difference(picture, picture);
    EXPECT_EQ(d.mean, 0);
    EXPECT_EQ(d.pixels, 0);
    EXPECT_TRUE(d.allowed());
}

TEST(PictureDifference, counts_a_pixel_once_and_weighs_the_mean) {
    const std::vector<float> expected = {1, 1, 1, 1, 1, 1, 1, 1};
    const std::vector<float> picture = {1.5f, 0.5f, 1, 1, 1, 1, 1, 1};
    const PictureDifference d = difference(picture, expected);
    // Two halves over a sum of eight, and one pixel of two: exact in binary.
    EXPECT_EQ(d.mean, 0.125);
    EXPECT_EQ(d.pixels, 0.5);
    EXPECT_FALSE(d.allowed());
}

TEST(PictureDifference, overlooks_rounding) {
    const std::vector<float> expected = {1, 1, 1, 1};
    const PictureDifference d = difference(std::vector<float>{1.0001f, 1, 1, 1}, expected);
    EXPECT_EQ(d.pixels, 0);
    EXPECT_TRUE(d.allowed());
}

TEST(PictureDifference, finds_what_is_not_a_number) {
    const std::vector<float> expected = {1, 1, 1, 1};
    EXPECT_FALSE(difference(std::vector<float>{std::numeric_limits<float>::quiet_NaN(), 1, 1, 1}, expected).allowed());
}

TEST(PictureDifference, finds_light_where_all_is_black) {
    const std::vector<float> black(4, 0.0f);
    EXPECT_FALSE(difference(std::vector<float>{1e-3f, 0, 0, 0}, black).allowed());
}

}  // namespace raymill::bench
