#include "profile/statistics.hpp"

#include <gtest/gtest.h>

namespace raymill::profile {

TEST(Quartiles, of_an_odd_number_of_values_are_among_them) {
    const Quartiles q = quartiles({5, 1, 4, 2, 3});
    EXPECT_EQ(q.lower, 2);
    EXPECT_EQ(q.median, 3);
    EXPECT_EQ(q.upper, 4);
}

TEST(Quartiles, of_an_even_number_of_values_lie_between_them) {
    const Quartiles q = quartiles({4, 1, 3, 2});
    // Multiples of 1/4: exact in binary.
    EXPECT_EQ(q.lower, 1.75);
    EXPECT_EQ(q.median, 2.5);
    EXPECT_EQ(q.upper, 3.25);
}

TEST(Quartiles, of_one_value_are_that_value) {
    const Quartiles q = quartiles({7});
    EXPECT_EQ(q.lower, 7);
    EXPECT_EQ(q.median, 7);
    EXPECT_EQ(q.upper, 7);
}

TEST(Quartiles, are_not_moved_by_one_outlier) {
    EXPECT_EQ(quartiles({1, 1, 1, 1, 1000}).median, 1);
    EXPECT_EQ(quartiles({1, 1, 1, 1, 1000}).upper, 1);
}

TEST(GeometricMean, of_a_ratio_and_its_inverse_is_one) {
    // log and exp each round by less than 1e-15 here.
    EXPECT_NEAR(geometric_mean({4, 0.25}), 1, 1e-14);
}

TEST(GeometricMean, of_one_value_is_that_value) {
    // As above, times the value.
    EXPECT_NEAR(geometric_mean({3}), 3, 1e-14);
}

}  // namespace raymill::profile
