// Sweeper: what an interrupt means to it. profile_test.cpp has what the program does with it.
#include "cli/sweep.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

/// A sweep of one setting whose kernels do not build.
class SweepThatFails : public testing::Test {
  protected:
    SweepThatFails() {
        write_text(folder_.file("scene.toml"), small_scene());
        std::filesystem::copy(RAYMILL_KERNELS, folder_.path() / "kernels", std::filesystem::copy_options::recursive);
        write_text(folder_.file("kernels/generate.cl"), "this is no kernel\n");
        scene_ = load_scene(folder_.file("scene.toml"));
        bvh_ = build_bvh(scene_.vertices, scene_.triangles, scene_.spheres, {});
        arguments_.kernel_dir = folder_.file("kernels");
    }

    const TemporaryFolder folder_;
    Scene scene_;
    Bvh bvh_;
    DeviceArguments arguments_;
    const SweepLists lists_{{64}, {0}, {0}, 1};
    ProgressBar bar_{false};
    const InterruptGuard guard_;
};

TEST_F(SweepThatFails, says_why) {
    Sweeper sweeper(arguments_, lists_, scene_, bvh_, guard_, bar_);
    EXPECT_THROW(sweeper.time_frame(), DeviceError);
    profile::Sweep sweep;
    EXPECT_THROW(sweeper.run(sweep), DeviceError);
    EXPECT_TRUE(contains(sweep.settings.at(0).skipped, "the kernels do not build"));
}

// While kernels are built, a signal removes LLVM's temporary files, and the build fails.
TEST_F(SweepThatFails, because_of_an_interrupt_is_interrupted) {
    Sweeper sweeper(arguments_, lists_, scene_, bvh_, guard_, bar_);
    std::raise(SIGINT);
    ASSERT_TRUE(guard_.interrupted());
    EXPECT_EQ(sweeper.time_frame(), std::nullopt);
    profile::Sweep sweep;
    sweeper.run(sweep);
    EXPECT_FALSE(sweep.complete);
    EXPECT_EQ(sweep.settings.at(0).skipped, "");
    EXPECT_TRUE(sweep.settings.at(0).frames.empty());
}

}  // namespace
}  // namespace raymill
