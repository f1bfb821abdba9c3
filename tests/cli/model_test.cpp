// Bare models: the scene that is printed for one is the one that is rendered.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "exr_pixels.hpp"
#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

/// A pyramid of two materials on coordinates that decimals do not hold exactly.
constexpr const char* pyramid_obj = R"(mtllib pyramid.mtl
v 0.1 0 0.1
v 1.3 0 0.2
v 1.2 0 1.1
v 0 0 1.3
v 0.7 1.7 0.6
usemtl sides
f 2 1 5
f 3 2 5
f 4 3 5
f 1 4 5
usemtl ground
f 1 2 3 4
)";
constexpr const char* pyramid_mtl = R"(newmtl sides
Kd 0.7 0.3 0.1
Ks 0.3 0.3 0.3
Ns 20
illum 3
newmtl ground
Kd 0.2 0.4 0.2
)";

Picture render(const std::string& scene, const std::string& file) {
    const Outcome outcome = run_raymill({"render", scene, "--size", "40x30", "-o", file});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return read_picture(file);
}

TEST(the_scene_of_a_model, renders_to_the_bits_of_the_bare_model) {
    const TemporaryFolder folder;
    write_text(folder.file("pyramid.obj"), pyramid_obj);
    write_text(folder.file("pyramid.mtl"), pyramid_mtl);
    const Outcome scene = run_raymill({"scene", "pyramid.obj"}, {.folder = folder.path().string()});
    ASSERT_EQ(scene.status, 0) << scene.err;
    EXPECT_EQ(scene.err, "");
    write_text(folder.file("x.toml"), scene.out);

    const Picture bare = render(folder.file("pyramid.obj"), folder.file("bare.exr"));
    const Picture written = render(folder.file("x.toml"), folder.file("written.exr"));
    EXPECT_TRUE(same_pixels(bare, written)) << scene.out;
    // There is something in it: the model covers some of the picture and not all.
    int covered = 0;
    for (std::size_t i = 3; i < bare.rgba.size(); i += 4) covered += bare.rgba[i] == 1;
    EXPECT_GT(covered, 40 * 30 / 20);
    EXPECT_LT(covered, 40 * 30);
}

TEST(the_scene_of_a_model, that_is_none_is_refused) {
    const TemporaryFolder folder;
    expect_failure(run_raymill({"scene", folder.file("missing.obj")}), 2, "missing.obj");
    write_text(folder.file("scene.toml"), small_scene());
    expect_failure(run_raymill({"scene", folder.file("scene.toml")}), 2, "scene.toml");
}

std::vector<fs::path> model_files(const char* folder) {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(RAYMILL_TEST_DATA) / folder, none))
        for (const char* extension : {".obj", ".ply", ".gltf", ".glb"})
            if (entry.path().extension() == extension) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

/// Any file that others made: a picture, or status 2 and a sentence that names the file, and no picture.
void expect_rendered_or_refused(const fs::path& model, int& rendered) {
    SCOPED_TRACE(model.string());
    const TemporaryFolder folder;
    const std::string file = folder.file("picture.exr");
    const Outcome outcome = run_raymill({"render", model.string(), "--size", "32x24", "-o", file});
    if (outcome.status != 0) {
        expect_failure(outcome, 2, model.filename().string());
        EXPECT_EQ(folder.entries(), 0);
        return;
    }
    ++rendered;
    EXPECT_EQ(outcome.out, "");
    for (const float value : read_picture(file).rgba) ASSERT_TRUE(value >= 0 && value < 1e6f) << value;
}

class real_models : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(of, real_models, testing::Values("obj", "ply", "gltf"),
                         [](const auto& of) { return std::string(of.param); });

TEST_P(real_models, are_rendered_or_refused_with_a_sentence) {
    const std::vector<fs::path> files = model_files(GetParam());
    if (files.empty()) GTEST_SKIP() << "there are no models in " << RAYMILL_TEST_DATA << "/" << GetParam();
    int rendered = 0;
    for (const fs::path& file : files) expect_rendered_or_refused(file, rendered);
    EXPECT_GT(rendered, static_cast<int>(files.size()) / 2);
}

}  // namespace
}  // namespace raymill
