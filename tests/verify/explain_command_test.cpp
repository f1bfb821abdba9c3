// The two commands as a person runs them.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "frame.hpp"
#include "support/changed_kernels.hpp"

namespace raymill::verify {
namespace {

struct Outcome {
    int status;
    std::string out, err;
};

Outcome run(const std::string& arguments) {
    const TemporaryFolder folder;
    const std::string out = folder.path() / "out", err = folder.path() / "err";
    const std::string command = std::string(RAYMILL_PROGRAM) + " " + arguments + " >" + out + " 2>" + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(out), read_bytes(err)};
}

const std::string scene = RAYMILL_SOURCE_DIR "/tests/verify/branching.toml";

TEST(ExplainCommand, a_pixel_is_told_on_standard_output) {
    const Outcome outcome = run("explain " + scene + " --pixel 15,10");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("pixel (15, 10) of 24 x 18, 2 spp, depth 3"), std::string::npos);
    EXPECT_NE(outcome.out.find("): equal\n"), std::string::npos);
    EXPECT_EQ(outcome.err, "");
}

TEST(ExplainCommand, a_pixel_outside_the_image_is_a_usage_error) {
    for (const char* pixel : {"24,0", "0,18", "-1,0"}) {
        const Outcome outcome = run("explain " + scene + " --pixel=" + pixel);
        EXPECT_EQ(outcome.status, 2) << pixel;
        EXPECT_NE(outcome.err.find("columns 0 to 23 and rows 0 to 17"), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }
}

TEST(ExplainCommand, text_that_is_no_pixel_and_a_sample_that_is_none_are_usage_errors) {
    for (const char* arguments : {" --pixel 3", " --pixel 3,x", " --pixel 3,4,5", " --pixel 3,4 --sample 2", ""})
        EXPECT_EQ(run("explain " + scene + arguments).status, 2) << arguments;
}

TEST(ExplainCommand, the_rays_go_to_an_obj_file) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "rays.obj";
    EXPECT_EQ(run("explain " + scene + " --pixel 15,10 --sample 0 --obj " + file).status, 0);
    EXPECT_EQ(read_bytes(file).find("# sample 0, camera ray, depth 0, hits "), 0u);
    EXPECT_EQ(run("explain " + scene + " --pixel 15,10 --obj /no/such/folder/rays.obj").status, 1);
}

TEST(VerifyCommand, kernels_within_bounds_are_status_0_and_a_planted_bug_status_1) {
    const Outcome good = run("verify " + scene + " --size 16x12");
    EXPECT_EQ(good.status, 0) << good.out << good.err;
    EXPECT_NE(good.out.find("all within bounds"), std::string::npos);

    const TemporaryFolder folder;
    const std::filesystem::path kernels = folder.path() / "kernels";
    change_kernels(kernels, "secondary.cl", "leave_surfaces(world, s, side)", "leave_surfaces(world, s, -side)");
    if (HasFatalFailure()) return;
    const Outcome bad = run("verify " + scene + " --size 16x12 --kernel-dir " + kernels.string());
    EXPECT_EQ(bad.status, 1);
    EXPECT_NE(bad.out.find("starts on the right side"), std::string::npos) << bad.out;
}

}  // namespace
}  // namespace raymill::verify
