// glTF: containers, accessors, meshes, nodes, cameras and lights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_document.hpp"

namespace raymill {
namespace {

using testing::HasSubstr;

void expect_square(const Scene& scene) {
    ASSERT_EQ(scene.triangles.size(), 2u);
    const glm::vec3 corners[2][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    for (std::size_t t = 0; t < 2; ++t)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(position(scene, scene.triangles[t], c), corners[t][c]);
}

TEST(Gltf, is_the_same_from_data_uris_external_files_and_glb) {
    const SceneFiles files;
    GltfDocument document;
    document.square_faces();
    expect_square(files.load("a.gltf", document.text()));
    expect_square(files.load("a.glb", document.binary()));
    files.write("my data.bin", document.bytes() + "more");
    document.json["buffers"][0] = {{"byteLength", document.bytes().size()}, {"uri", "my%20data.bin"}};
    const Scene scene = files.load("a.gltf", document.json.dump());
    expect_square(scene);
    EXPECT_EQ(scene.objects.at(0).name, "it");
}

TEST(Gltf, indices_may_be_of_any_size_or_none) {
    for (const int type : {5121, 5123, 5125}) {
        GltfDocument document;
        document.square();
        auto& indices = document.primitive()["indices"];
        if (type == 5121) indices = document.accessor(std::vector<std::uint8_t>{0, 1, 2, 0, 2, 3}, "SCALAR", type, 6);
        if (type == 5123) indices = document.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", type, 6);
        if (type == 5125) indices = document.accessor(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, "SCALAR", type, 6);
        expect_square(document.load());
    }
    GltfDocument document;
    document.attribute("POSITION") = document.floats("VEC3", 6, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
    expect_square(document.load());
}

TEST(Gltf, strips_and_fans_face_the_same_way_throughout) {
    const std::pair<int, std::vector<std::uint16_t>> modes[] = {{5, {0, 1, 3, 2}}, {6, {0, 1, 2, 3}}};
    for (const auto& [mode, indices] : modes) {
        GltfDocument document;
        document.square();
        document.primitive()["mode"] = mode;
        document.primitive()["indices"] = document.accessor(indices, "SCALAR", 5123, 4);
        const Scene scene = document.load();
        ASSERT_EQ(scene.triangles.size(), 2u) << mode;
        for (const Triangle& triangle : scene.triangles) EXPECT_EQ(face_normal(scene, triangle), glm::vec3(0, 0, 1));
    }
}

TEST(Gltf, points_and_lines_are_left_out_with_a_warning) {
    for (int mode = 0; mode < 4; ++mode) {
        GltfDocument document;
        document.square();
        document.primitive()["mode"] = mode;
        const Scene scene = document.load();
        EXPECT_TRUE(scene.triangles.empty());
        EXPECT_TRUE(warns_of(scene, "points and lines"));
    }
}

TEST(Gltf, interleaved_and_sparse_accessors_are_read) {
    GltfDocument document;
    document.attribute("POSITION") = document.floats("VEC3", 3, {0, 0, 0, 9, 1, 0, 0, 9, 7, 7, 7});
    document.json["bufferViews"][0]["byteStride"] = 16;
    const int indices = document.accessor(std::vector<std::uint8_t>{2, 2, 2, 2}, "SCALAR", 5121, 1);
    const int values = document.floats("VEC3", 1, {1, 1, 0});
    document.json["accessors"][0]["sparse"] = {{"count", 1},
                                               {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                               {"values", {{"bufferView", values}}}};
    const Scene scene = document.load();
    ASSERT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(position(scene, scene.triangles[0], 1), glm::vec3(1, 0, 0));
    EXPECT_EQ(position(scene, scene.triangles[0], 2), glm::vec3(1, 1, 0));
}

TEST(Gltf, normalised_and_quantised_numbers_are_scaled) {
    GltfDocument document;
    document.json["extensionsRequired"] = document.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    const std::vector<std::int16_t> corners = {-32768, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0};
    document.attribute("POSITION") = document.accessor(corners, "VEC3", 5122, 3);
    document.json["bufferViews"][0]["byteStride"] = 8;
    document.json["accessors"][0]["normalized"] = true;
    document.attribute("NORMAL") =
        document.accessor(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, "VEC3", 5120, 3);
    document.json["bufferViews"][1]["byteStride"] = 4;
    document.json["accessors"][1]["normalized"] = true;
    const Scene scene = document.load();
    EXPECT_EQ(position(scene, scene.triangles.at(0), 0), glm::vec3(-1, 0, 0));
    EXPECT_EQ(position(scene, scene.triangles[0], 1), glm::vec3(1, 0, 0));
    EXPECT_EQ(vertex_normal(scene, scene.triangles[0], 2), glm::vec3(0, 0, 1));
}

TEST(Gltf, nodes_carry_their_children_and_mirrors_keep_the_outside_outside) {
    GltfDocument document;
    document.square_faces();
    document.attribute("NORMAL") = document.floats("VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    const double half = std::sqrt(0.5);
    document.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                              {{"children", {2}}, {"rotation", {0, 0, half, half}}},  // a quarter turn about z
                              {{"mesh", 0}, {"scale", {-2, 1, 1}}}};
    const Scene scene = document.load();
    ASSERT_EQ(scene.triangles.size(), 2u);
    bool found = false;
    for (const Triangle& triangle : scene.triangles) {
        EXPECT_NEAR(face_normal(scene, triangle).z, 1, 1e-6);  // floats near 1
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(vertex_normal(scene, triangle, c).z, 1, 1e-6);
            // (1, 1, 0) is scaled to (-2, 1, 0), turned to (-1, -2, 0), moved to (9, -2, 0).
            found |= glm::distance(position(scene, triangle, c), glm::vec3(9, -2, 0)) < 1e-6f;
        }
    }
    EXPECT_TRUE(found);
}

TEST(Gltf, matrices_are_columns_and_only_the_default_scene_is_shown) {
    GltfDocument document;
    document.square_faces();
    document.json["nodes"][1] = {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}};
    document.json["scenes"][1]["nodes"] = {1};
    EXPECT_EQ(position(document.load(), document.load().triangles.at(0), 0), glm::vec3(0, 0, 0));
    document.json["scene"] = 1;
    EXPECT_EQ(position(document.load(), document.load().triangles.at(0), 0), glm::vec3(5, 6, 7));
    document.json.erase("scene");
    document.json.erase("scenes");
    EXPECT_EQ(document.load().triangles.size(), 4u);  // all roots
}

TEST(Gltf, in_a_scene_file_is_placed_and_may_take_its_material) {
    const SceneFiles files;
    GltfDocument document;
    document.square_faces();
    document.primitive()["material"] = 0;
    document.json["materials"][0] = {{"name", "own"}};
    document.json["nodes"][0]["translation"] = {1, 0, 0};
    files.write("a.gltf", document.text());
    const std::string object = "[[object]]\nshape = \"mesh\"\nfile = \"a.gltf\"\nscale = 2\n";
    const Scene own = files.toml(object);
    EXPECT_EQ(position(own, own.triangles.at(0), 0), glm::vec3(2, 0, 0));
    EXPECT_EQ(own.materials.at(own.triangles[0].material).name, "own");
    const Scene given = files.toml("[[material]]\nname = \"m\"\n" + object + "material = \"m\"\n");
    EXPECT_EQ(given.materials.at(given.triangles.at(0).material).name, "m");
}

TEST(Gltf, vertex_colors_multiply_the_base_color_and_white_ones_are_none) {
    GltfDocument document;
    document.square_faces();
    document.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 1, 1};
    document.primitive()["material"] = 0;
    document.attribute("COLOR_0") = document.accessor(std::vector<std::uint8_t>(16, 255), "VEC4", 5121, 4);
    document.json["accessors"][2]["normalized"] = true;
    EXPECT_EQ(document.load().materials.size(), 2u);
    document.attribute("COLOR_0") = document.floats("VEC3", 4, {1, 0.5f, 0, 1, 0.5f, 0, 1, 0.5f, 0, 1, 0.5f, 0});
    const Scene scene = document.load();
    EXPECT_EQ(scene.materials.at(scene.triangles.at(0).material).diffuse, glm::vec3(0.5f, 0.5f, 0));
}

/// A square with a camera in front of it and one light of each type above, turned down.
GltfDocument with_view() {
    GltfDocument document;
    document.square_faces();
    const double half = std::sqrt(0.5);
    document.json["nodes"][1] = {{"camera", 0}, {"translation", {0, 0, 4}}};
    document.json["cameras"][0] = {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}};
    const char* types[] = {"directional", "point", "spot"};
    for (int i = 0; i < 3; ++i) {
        auto& light = document.json["extensions"]["KHR_lights_punctual"]["lights"][i];
        light = {{"type", types[i]}, {"intensity", 100 * (i + 1)}, {"color", {1, 0.5, 0}}};
        if (i == 2) light["spot"] = {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}};
        auto& node = document.json["nodes"][2 + i];
        node["extensions"]["KHR_lights_punctual"]["light"] = i;
        node["rotation"] = {-half, 0, 0, half};  // -z becomes -y
        node["translation"] = {0, 3, 0};
    }
    document.json["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};
    document.json["extensionsUsed"] = document.json["extensionsRequired"] = {"KHR_lights_punctual"};
    return document;
}

TEST(Gltf, cameras_and_lights_of_a_bare_model_are_used) {
    const Scene scene = with_view().load();
    EXPECT_EQ(scene.camera.eye, glm::dvec3(0, 0, 4));
    EXPECT_EQ(scene.camera.look_at, glm::dvec3(0, 0, 3));
    EXPECT_EQ(scene.camera.up, glm::dvec3(0, 1, 0));
    EXPECT_DOUBLE_EQ(scene.camera.fov, glm::degrees(0.5));
    ASSERT_EQ(scene.lights.size(), 3u);
    const float pi = glm::pi<float>();
    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        return glm::distance(a, b) < 1e-5f * glm::length(b);
    };
    const auto& sun = std::get<DirectionalLight>(scene.lights[0].light);
    EXPECT_TRUE(near(sun.intensity, glm::vec3(1, 0.5f, 0) * (100 / pi)));
    EXPECT_TRUE(near(sun.direction, glm::vec3(0, -1, 0)));
    const auto& point = std::get<PointLight>(scene.lights[1].light);
    EXPECT_TRUE(near(point.intensity, glm::vec3(1, 0.5f, 0) * (200 / pi)));
    EXPECT_EQ(point.position, glm::vec3(0, 3, 0));
    EXPECT_EQ(point.attenuation, glm::vec3(0, 0, 1));
    const auto& spot = std::get<SpotLight>(scene.lights[2].light);
    EXPECT_FLOAT_EQ(spot.inner_angle, glm::degrees(0.25f));
    EXPECT_FLOAT_EQ(spot.outer_angle, glm::degrees(0.5f));
    EXPECT_TRUE(near(spot.direction, glm::vec3(0, -1, 0)));
    // A white surface in the middle, at distance sqrt(0.5^2 + 2.5^2) of the lamps, is shown at 0.8, to a tenth of a
    // stop.
    const double light = 100 / pi + 500 / pi / 6.5;
    EXPECT_NEAR(scene.settings.exposure, std::log2(0.8 / light), 0.06);
}

TEST(Gltf, cameras_may_be_orthographic) {
    GltfDocument document = with_view();
    document.json["cameras"][0] = {{"type", "orthographic"},
                                   {"orthographic", {{"xmag", 2}, {"ymag", 1.5}, {"znear", 0.1}, {"zfar", 9}}}};
    const Scene scene = document.load();
    EXPECT_EQ(scene.camera.projection, Projection::orthographic);
    EXPECT_EQ(scene.camera.height, 3);
}

TEST(Gltf, the_scene_printed_for_a_model_with_camera_and_lights_is_the_same_scene) {
    const SceneFiles files;
    GltfDocument document = with_view();
    for (const char* kind : {"perspective", "orthographic"}) {
        if (std::string(kind) == "orthographic")
            document.json["cameras"][0] = {{"type", kind}, {"orthographic", {{"xmag", 2}, {"ymag", 1.7}}}};
        const std::string model = files.write("a.gltf", document.text());
        const Scene bare = load_scene(model), written = files.toml(model_scene_toml(model));
        EXPECT_EQ(written.camera.projection, bare.camera.projection);
        EXPECT_EQ(written.camera.eye, bare.camera.eye);
        EXPECT_EQ(written.camera.look_at, bare.camera.look_at);
        EXPECT_EQ(written.camera.fov, bare.camera.fov);
        EXPECT_EQ(written.camera.height, bare.camera.height);
        EXPECT_EQ(written.settings.exposure, bare.settings.exposure);
        ASSERT_EQ(written.lights.size(), 3u);
        const auto &a = std::get<SpotLight>(written.lights[2].light), &b = std::get<SpotLight>(bare.lights[2].light);
        EXPECT_EQ(a.position, b.position);
        EXPECT_EQ(a.direction, b.direction);
        EXPECT_EQ(a.intensity, b.intensity);
        EXPECT_EQ(a.attenuation, b.attenuation);
        EXPECT_EQ(a.inner_angle, b.inner_angle);
        EXPECT_EQ(a.outer_angle, b.outer_angle);
        EXPECT_EQ(std::get<DirectionalLight>(written.lights[0].light).intensity,
                  std::get<DirectionalLight>(bare.lights[0].light).intensity);
    }
}

TEST(Gltf, what_is_not_supported_is_named_in_one_warning) {
    GltfDocument document;
    document.square_faces();
    document.json["extensionsUsed"] = {"VENDOR_thing"};
    document.json["skins"][0]["joints"] = {0};
    document.json["animations"][0] = {{"channels", nlohmann::json::array()}, {"samplers", nlohmann::json::array()}};
    document.primitive()["targets"][0]["POSITION"] = 0;
    const Scene scene = document.load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    for (const char* what : {"VENDOR_thing", "skins", "animations", "morph targets"})
        EXPECT_THAT(scene.warnings[0].message, HasSubstr(what));
}

}  // namespace
}  // namespace raymill
