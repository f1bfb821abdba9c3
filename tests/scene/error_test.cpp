#include "scene/error.hpp"

#include <gtest/gtest.h>

namespace raymill {
namespace {

TEST(SceneErrorText, names_file_line_and_column) {
    EXPECT_EQ(to_string(Diagnostic{{"x.toml", 12, 9}, "light 2: wrong"}), "x.toml:12:9: light 2: wrong");
}

TEST(SceneErrorText, leaves_out_what_is_not_known) {
    EXPECT_EQ(to_string(SourcePosition{"x.obj", 7, 0}), "x.obj:7");
    EXPECT_EQ(to_string(SourcePosition{"x.obj", 0, 3}), "x.obj");
    EXPECT_EQ(to_string(Diagnostic{{}, "no place"}), "no place");
}

TEST(SceneErrorText, shows_twenty_faults_and_counts_the_rest) {
    const auto text_of = [](std::size_t count) {
        return std::string(SceneError(std::vector<Diagnostic>(count, {{"x", 1, 1}, "bad"})).what());
    };
    const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n') + 1; };
    EXPECT_EQ(lines(text_of(20)), 20);
    EXPECT_TRUE(text_of(20).ends_with("x:1:1: bad"));
    EXPECT_EQ(lines(text_of(21)), 21);
    EXPECT_TRUE(text_of(21).ends_with("\nand 1 more error"));
    EXPECT_TRUE(text_of(25).ends_with("\nand 5 more errors"));
    EXPECT_EQ(SceneError(std::vector<Diagnostic>(25)).diagnostics().size(), 25u);
}

}  // namespace
}  // namespace raymill
