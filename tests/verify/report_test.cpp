// What counts as an error.
#include <gtest/gtest.h>

#include <cmath>

#include "verify/report.hpp"

namespace raymill::verify {
namespace {

Comparison with_field(double kernel, double reference, double bound) {
    Comparison c;
    c.number("x", kernel, reference, bound);
    return c;
}

TEST(Report, an_error_up_to_its_bound_passes_and_one_beyond_it_fails) {
    EXPECT_FALSE(with_field(1.25, 1, 0.25).failed());
    EXPECT_TRUE(with_field(1.25, 1, 0.2).failed());
    EXPECT_DOUBLE_EQ(with_field(1.25, 1, 0.5).ratio(), 0.5);
}

TEST(Report, not_a_number_fails_whatever_the_bound) {
    EXPECT_TRUE(with_field(NAN, 1, 10).failed());
    EXPECT_TRUE(with_field(INFINITY, 1, 10).failed());
}

TEST(Report, the_same_infinity_passes) {
    EXPECT_FALSE(with_field(INFINITY, INFINITY, 0).failed());
}

TEST(Report, exact_fields_allow_no_difference) {
    Comparison c;
    c.same("path", 0xffffffffu, 0xffffffffu);
    EXPECT_FALSE(c.failed());
    c.same("path", 0xffffffffu, 0xfffffffeu);
    EXPECT_TRUE(c.failed());
}

TEST(Report, another_branch_is_excused_below_its_margin_s_bound_alone) {
    Comparison c = with_field(5, 1, 0.1);
    c.disagree("another branch", 0.5);
    EXPECT_FALSE(c.failed());
    c.disagree("another branch", 1);
    EXPECT_TRUE(c.failed());
}

TEST(Report, the_first_failure_is_kept_in_full) {
    StageReport report("shade");
    report.add(with_field(1, 1, 0), [] { return std::string("fine\n"); });
    report.add(with_field(2, 1, 0.5), [] { return std::string("second item\n"); });
    report.add(with_field(3, 1, 0.5), [] { return std::string("third item\n"); });
    EXPECT_EQ(report.failures(), 2u);
    EXPECT_EQ(report.compared(), 3u);
    EXPECT_EQ(report.first_failure().find("second item"), 0u);
    EXPECT_NE(report.first_failure().find("x"), std::string::npos);
    EXPECT_DOUBLE_EQ(report.worst(), 4);
    EXPECT_DOUBLE_EQ(report.typical(), 2);
}

TEST(Report, a_table_names_every_kernel_and_the_item_that_differs) {
    StageReport good("shade"), bad("shadow");
    bad.add(with_field(2, 1, 0.5), [] { return std::string("the item\n"); });
    const std::string text = report_text({good, bad});
    EXPECT_NE(text.find("\nshade "), std::string::npos);
    EXPECT_NE(text.find("shadow: 1 out of bounds; the first:\nthe item\n"), std::string::npos);
}

}  // namespace
}  // namespace raymill::verify
