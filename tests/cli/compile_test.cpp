// Kernels compiled ahead of a render, or at its start by two processes.
#include <gtest/gtest.h>

#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

/// PoCL with a cache of its own, empty at first.
class EmptyCache : public testing::Test {
  protected:
    EmptyCache() { write_text(scene_, small_scene()); }

    Outcome run(const std::vector<std::string>& arguments) {
        return run_raymill(arguments, {.environment = {{"POCL_CACHE_DIR", cache_.path().string()}}});
    }
    Outcome render() { return run({"render", scene_, "-o", folder_.file("a.exr"), "--stats"}); }

    const TemporaryFolder cache_, folder_;
    const std::string scene_ = folder_.file("scene.toml");
};

bool runtime_does_not_tell(const Outcome& outcome) {
    return contains(outcome.out, "does not tell");
}

TEST_F(EmptyCache, is_filled_by_compile) {
    const Outcome first = run({"compile"});
    ASSERT_EQ(first.status, 0) << first.err;
    if (runtime_does_not_tell(first)) GTEST_SKIP() << first.out;
    EXPECT_EQ(first.out, "5 kernels compiled, 0 found in the cache\n");
    EXPECT_EQ(run({"compile"}).out, "0 kernels compiled, 5 found in the cache\n");
    const Outcome render_after = render();
    EXPECT_TRUE(contains(render_after.err, "(1 compiled in this run, 5 from the cache)")) << render_after.err;
}

TEST_F(EmptyCache, is_filled_stage_by_stage) {
    const Outcome two = run({"compile", "--stages", "secondary,generate"});
    ASSERT_EQ(two.status, 0) << two.err;
    if (runtime_does_not_tell(two)) GTEST_SKIP() << two.out;
    EXPECT_EQ(two.out, "2 kernels compiled, 0 found in the cache\n");
    EXPECT_EQ(run({"compile", "--stages", "generate"}).out, "0 kernels compiled, 1 found in the cache\n");
}

TEST_F(EmptyCache, is_filled_by_the_first_render) {
    const Outcome first = render(), second = render();
    ASSERT_EQ(first.status, 0) << first.err;
    if (!contains(second.err, "compiled in this run")) GTEST_SKIP() << "this OpenCL runtime does not tell";
    EXPECT_TRUE(contains(first.err, "(6 compiled in this run, 0 from the cache)")) << first.err;
    EXPECT_TRUE(contains(second.err, "(0 compiled in this run, 6 from the cache)")) << second.err;
}

TEST(compile, names_what_it_does_not_know) {
    expect_failure(run_raymill({"compile", "--stages", "resolve"}), 2, "resolve");
}

}  // namespace
}  // namespace raymill
