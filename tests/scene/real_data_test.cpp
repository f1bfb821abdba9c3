// Models and pictures that others wrote: each loads, or is refused in a sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scene/texture.hpp"
#include "scene_files.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

const fs::path data = RAYMILL_DATA;

#define SKIP_WITHOUT_DATA() \
    if (!fs::exists(data)) GTEST_SKIP() << "the folder of test data is not there: " << data

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(RealModels, load_or_are_refused_in_a_sentence) {
    SKIP_WITHOUT_DATA();
    std::size_t loaded = 0;
    std::vector<std::string> refused;
    for (const auto& entry : fs::recursive_directory_iterator(data / "obj")) {
        if (entry.path().extension() != ".obj") continue;
        try {
            const Scene scene = load_scene(entry.path().string());
            for (const Triangle& t : scene.triangles) {
                ASSERT_LT(t.material, scene.materials.size());
                ASSERT_LT(t.object, scene.objects.size());
                for (const uint vertex : t.vertex) ASSERT_LT(vertex, scene.vertices.size());
            }
            ++loaded;
        } catch (const SceneError& error) {
            refused.push_back(entry.path().filename().string());
            EXPECT_THAT(error.what(), testing::HasSubstr(refused.back() + ":"));
        }
    }
    EXPECT_GT(loaded, 50u);
    EXPECT_THAT(refused,
                testing::UnorderedElementsAre("invalid-relative-texture-index.obj", "invalid-relative-vertex-index.obj",
                                              "issue-140-zero-face-idx.obj"));
}

TEST(RealModels, have_the_triangles_that_their_index_counts) {
    SKIP_WITHOUT_DATA();
    const std::pair<const char*, std::size_t> models[] = {{"obj/cornell-box/CornellBox-Sphere.obj", 2188},
                                                          {"obj/cornell-box/CornellBox-Glossy.obj", 1112},
                                                          {"obj/egyptcat/egyptcat.obj", 16040},
                                                          {"obj/psor-cube/psor-cube.obj", 33796},
                                                          {"obj/legocar/legocar.obj", 10992}};
    for (const auto& [file, count] : models) EXPECT_EQ(load_scene((data / file).string()).triangles.size(), count);
}

TEST(RealModels, of_cornell_boxes_are_seen_from_their_open_side) {
    SKIP_WITHOUT_DATA();
    for (const auto& entry : fs::directory_iterator(data / "obj/cornell-box")) {
        if (entry.path().extension() != ".obj") continue;
        const Camera camera = load_scene(entry.path().string()).camera;
        const glm::dvec3 towards_eye = glm::normalize(camera.eye - camera.look_at);
        EXPECT_NEAR(towards_eye.z, 1, 1e-6) << entry.path();  // six digits
    }
}

TEST(RealModels, with_a_texture_have_it_in_linear_light) {
    SKIP_WITHOUT_DATA();
    const Scene scene = load_scene((data / "obj/egyptcat/egyptcat.obj").string());
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_GT(scene.images[0].width, 100u);
    bool used = false;
    for (const SceneMaterial& m : scene.materials) used |= m.diffuse_map == 0u;
    EXPECT_TRUE(used);
}

TEST(RealPictures, of_openexr_decode) {
    SKIP_WITHOUT_DATA();
    for (const auto& entry : fs::recursive_directory_iterator(data / "exr/valid")) {
        if (entry.path().extension() != ".exr") continue;
        std::size_t mended = 0;
        const TextureImage image = decode_texture(bytes_of(entry.path()), entry.path().string(), mended);
        EXPECT_EQ(image.texels.size(), std::size_t{image.width} * image.height) << entry.path();
    }
}

TEST(RealPictures, that_are_damaged_decode_or_are_refused_with_a_reason) {
    SKIP_WITHOUT_DATA();
    std::size_t refused = 0;
    for (const fs::path& folder : {data / "exr/damaged", data / "img/pngsuite"})
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            if (!entry.is_regular_file()) continue;
            std::size_t mended = 0;
            try {
                decode_texture(bytes_of(entry.path()), entry.path().string(), mended);
            } catch (const std::exception& fault) {
                EXPECT_STRNE(fault.what(), "") << entry.path();
                ++refused;
            }
        }
    EXPECT_GT(refused, 60u);
}

TEST(RealPictures, of_radiance_environments_decode) {
    SKIP_WITHOUT_DATA();
    for (const auto& entry : fs::directory_iterator(data / "env")) {
        std::size_t mended = 0;
        const TextureImage image = decode_texture(bytes_of(entry.path()), entry.path().string(), mended);
        EXPECT_EQ(image.width, 2 * image.height) << entry.path();
        EXPECT_EQ(mended, 0u);
    }
}

}  // namespace
}  // namespace raymill
