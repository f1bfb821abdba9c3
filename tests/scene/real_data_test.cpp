// Models and pictures that others wrote: each loads, or is refused in a sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

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

TEST(RealModels, of_gltf_and_ply_have_the_triangles_that_their_index_counts) {
    SKIP_WITHOUT_DATA();
    const std::pair<const char*, std::size_t> models[] = {{"gltf/FlightHelmet/FlightHelmet.gltf", 94722},
                                                          {"gltf/balloon/scene.gltf", 35698},
                                                          {"gltf/gdx/nominal/gltf/basicMaterials.glb", 3520},
                                                          {"gltf/bevy-basic/torus/torus.gltf", 3072},
                                                          {"gltf/box/Box_glTF-Embedded/Box.gltf", 12},
                                                          {"ply/teapot.ply", 3206},
                                                          {"ply/tinyply/sofa.ply", 24104},
                                                          {"ply/tinyply/sofa_ascii.ply", 24104},
                                                          {"lux/psor-cube/Cubo_Prism_01_MAT.ply", 33792}};
    for (const auto& [file, count] : models)
        EXPECT_EQ(load_scene((data / file).string()).triangles.size(), count) << file;
}

TEST(RealModels, in_three_containers_or_encodings_are_the_same) {
    SKIP_WITHOUT_DATA();
    const std::vector<const char*> sets[] = {
        {"gltf/box/Box_glTF/Box.gltf", "gltf/box/Box_glTF-Binary/Box.glb", "gltf/box/Box_glTF-Embedded/Box.gltf"},
        {"ply/happly/platonic_shelf.ply", "ply/happly/platonic_shelf_ascii.ply",
         "ply/happly/platonic_shelf_big_endian.ply"}};
    for (const auto& set : sets) {
        const Scene first = load_scene((data / set[0]).string());
        ASSERT_GT(first.triangles.size(), 0u);
        for (const char* file : set) {
            const Scene scene = load_scene((data / file).string());
            ASSERT_EQ(scene.triangles.size(), first.triangles.size()) << file;
            for (std::size_t t = 0; t < first.triangles.size(); ++t)
                for (int c = 0; c < 3; ++c)
                    EXPECT_EQ(position(scene, scene.triangles[t], c), position(first, first.triangles[t], c)) << file;
        }
    }
}

/// What the glTF validator's report beside the file calls errors, as "CODE /pointer" lines.
std::string reported_errors(const fs::path& file) {
    const auto report = nlohmann::json::parse(bytes_of(file.string() + ".report.json"));
    std::string errors = "\n";
    for (const auto& message : report["issues"]["messages"])
        if (message["severity"] == 0) errors += message["code"].get<std::string>() + '\n';
    return errors;
}

TEST(RealModels, that_the_gltf_validator_calls_broken_are_refused_where_it_concerns_what_is_drawn) {
    SKIP_WITHOUT_DATA();
    // References to nothing, data outside its buffer, and containers that are none.
    const std::vector<std::string> fatal = {"UNRESOLVED_REFERENCE", "GLB_UNEXPECTED",        "GLB_INVALID",
                                            "GLB_LENGTH",           "GLB_EMPTY_CHUNK",       "NODE_PARENT_OVERRIDE",
                                            "NODE_MATRIX",          "SCENE_NON_ROOT_NODE",   "BUFFER_BYTE_LENGTH",
                                            "UNKNOWN_ASSET_MAJOR",  "CAMERA_XMAG_YMAG_ZERO", "ACCESSOR_SPARSE_COUNT"};
    std::size_t refused = 0, loaded = 0;
    for (const auto& entry : fs::recursive_directory_iterator(data / "gltf/validator")) {
        const fs::path& file = entry.path();
        if (file.extension() != ".gltf" && file.extension() != ".glb") continue;
        const std::string errors = reported_errors(file);
        bool must_fail = false;
        // Variants of materials are an extension that is left out.
        if (file.string().find("KHR_materials_variants") == std::string::npos)
            for (const std::string& code : fatal) must_fail |= errors.find('\n' + code) != std::string::npos;
        try {
            load_scene(file.string());
            EXPECT_FALSE(must_fail) << file << ' ' << errors;
            ++loaded;
        } catch (const SceneError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(file.filename().string() + ":")) << file;
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 50u);
    EXPECT_GT(loaded, 100u);
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
