// With OpenCL, without it, and with kernels that do not build.
#include <gtest/gtest.h>

#include <filesystem>

#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

TEST(devices, lists_at_least_one_with_what_matters) {
    const Outcome outcome = run_raymill({"devices"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("0: ")) << outcome.out;
    for (const char* part : {"platform", "version", "compute units", "memory", "usable"})
        EXPECT_TRUE(contains(outcome.out, part)) << outcome.out << "\nwithout " << part;
    EXPECT_EQ(outcome.err, "");
}

/// A machine whose ICD loader finds no platform.
class NoOpenCL : public testing::Test {
  protected:
    NoOpenCL() { write_text(scene_, small_scene()); }

    Outcome run(const std::vector<std::string>& arguments) {
        return run_raymill(arguments, {.environment = {{"OCL_ICD_VENDORS", vendors_.path().string()},
                                                       {"OPENCL_VENDOR_PATH", vendors_.path().string()}}});
    }

    const TemporaryFolder vendors_, folder_;
    const std::string scene_ = folder_.file("scene.toml");
};

TEST_F(NoOpenCL, says_how_to_install_pocl) {
    expect_failure(run({"devices"}), 1, "apt-get install pocl-opencl-icd");
    expect_failure(run({"render", scene_, "-o", folder_.file("a.exr")}), 1, "apt-get install pocl-opencl-icd");
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(NoOpenCL, still_checks_scenes_and_prints_models_and_help) {
    const Outcome check = run({"check", scene_});
    EXPECT_EQ(check.status, 0) << check.err;
    EXPECT_TRUE(contains(check.out, "no OpenCL device")) << check.out;
    write_text(folder_.file("model.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(run({"scene", folder_.file("model.obj")}).status, 0);
    EXPECT_EQ(run({"render", "--help"}).status, 0);
}

class KernelFolder : public testing::Test {
  protected:
    KernelFolder() {
        write_text(scene_, small_scene());
        fs::copy(RAYMILL_KERNELS, kernels_.path(), fs::copy_options::recursive);
    }
    Outcome render() {
        return run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--kernel-dir", kernels_.path().string()});
    }

    const TemporaryFolder folder_, kernels_;
    const std::string scene_ = folder_.file("scene.toml");
};

TEST_F(KernelFolder, of_the_sources_renders) {
    const Outcome outcome = render();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(folder_.entries(), 2);
}

TEST_F(KernelFolder, with_a_fault_shows_the_build_log_with_file_and_line) {
    const std::string shade = read_bytes(kernels_.file("shade.cl"));
    write_text(kernels_.file("shade.cl"), shade + "kernel void broken(global int* p) { *p = nonsense; }\n");
    const Outcome outcome = render();
    EXPECT_EQ(outcome.status, 1);
    // The driver may print lines of its own before.
    EXPECT_TRUE(contains(outcome.err, "raymill: the kernels do not build")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "nonsense")) << outcome.err;
    const std::string line = std::to_string(count_lines(shade) + 1);
    EXPECT_TRUE(contains(outcome.err, "shade.cl:" + line)) << outcome.err;
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(KernelFolder, without_a_file_names_it) {
    fs::remove(kernels_.path() / "lib" / "film.h");
    expect_failure(render(), 1, "film.h");
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(KernelFolder, that_lacks_a_kernel_names_it) {
    write_text(kernels_.file("resolve.cl"), "#include \"lib/math.h\"\n");
    expect_failure(render(), 1, "resolve");
}

}  // namespace
}  // namespace raymill
