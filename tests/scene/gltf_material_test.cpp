// glTF's materials.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_document.hpp"

namespace raymill {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A square of the material; `document` may be given textures before.
Scene load_with(const json& material, GltfDocument document = {}) {
    document.square_faces();
    document.attribute("TEXCOORD_0") = document.floats("VEC2", 4, {0, 0, 1, 0, 1, 1, 0, 1});
    document.primitive()["material"] = 0;
    document.json["materials"][0] = material;
    return document.load();
}

SceneMaterial converted(const json& material) {
    const Scene scene = load_with(material);
    return scene.materials.at(scene.triangles.at(0).material);
}

json pbr(double metallic, double roughness) {
    return {{"name", "m"},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {0.5, 0.25, 1, 1}}, {"metallicFactor", metallic}, {"roughnessFactor", roughness}}}};
}

const glm::vec3 color(0.5f, 0.25f, 1);

TEST(GltfMaterial, of_a_dielectric_is_diffuse_with_a_highlight_as_wide_as_its_roughness) {
    const SceneMaterial m = converted(pbr(0, 0.5));
    EXPECT_EQ(m.name, "m");
    EXPECT_EQ(m.diffuse, color);
    EXPECT_EQ(m.ambient, color);
    EXPECT_EQ(m.highlight, Highlight::blinn);
    EXPECT_FLOAT_EQ(m.shininess, 2 / 0.0625f - 2);  // 2 / r^4 - 2
    EXPECT_FLOAT_EQ(m.specular.g, 0.04f * 32 / 8);  // F0 (s + 2) / 8
    EXPECT_EQ(m.reflection, 0);
    EXPECT_EQ(m.transmission, 0);
}

TEST(GltfMaterial, of_a_metal_mirrors_in_its_color_the_smoother_the_more) {
    const SceneMaterial smooth = converted(pbr(1, 0)), half = converted(pbr(1, 0.5)), rough = converted(pbr(1, 1));
    EXPECT_EQ(smooth.reflection, 1);
    EXPECT_EQ(smooth.base_color, color);
    EXPECT_EQ(smooth.shininess, 10000);
    EXPECT_EQ(half.reflection, 0.25f);
    EXPECT_EQ(rough.reflection, 0);
    EXPECT_EQ(rough.shininess, 0);
    EXPECT_EQ(rough.specular, color * 0.25f);
    EXPECT_EQ(rough.diffuse, color);
}

TEST(GltfMaterial, emits_its_factor_times_its_strength) {
    json material = pbr(0, 1);
    material["emissiveFactor"] = {1, 0.5, 0};
    material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 6;
    EXPECT_EQ(converted(material).emission, glm::vec3(6, 3, 0));
}

TEST(GltfMaterial, that_transmits_is_glass_with_an_index_and_a_thin_sheet_without) {
    json material = pbr(0, 0);
    auto& extensions = material["extensions"];
    extensions["KHR_materials_transmission"]["transmissionFactor"] = 0.75;
    const SceneMaterial sheet = converted(material);
    EXPECT_EQ(sheet.transmission, 0.75f);
    EXPECT_EQ(sheet.ior, 1);
    EXPECT_FALSE(sheet.fresnel);
    EXPECT_EQ(sheet.base_color, color);
    extensions["KHR_materials_ior"]["ior"] = 1.25;
    const SceneMaterial glass = converted(material);
    EXPECT_EQ(glass.ior, 1.25f);
    EXPECT_TRUE(glass.fresnel);
    extensions.erase("KHR_materials_ior");
    extensions["KHR_materials_volume"] = {
        {"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {0.5, 1, 0.25}}};
    const SceneMaterial volume = converted(material);
    EXPECT_EQ(volume.ior, 1.5f);
    EXPECT_TRUE(volume.fresnel);
    EXPECT_FLOAT_EQ(volume.absorption.r, std::log(2.0f) / 2);
    EXPECT_EQ(volume.absorption.g, 0);
    EXPECT_FLOAT_EQ(volume.absorption.b, std::log(4.0f) / 2);
}

TEST(GltfMaterial, specular_scales_the_reflectance_and_its_index_sets_it) {
    json material = pbr(0, 1);
    auto& extensions = material["extensions"];
    extensions["KHR_materials_ior"]["ior"] = 3;
    EXPECT_FLOAT_EQ(converted(material).specular.r, 0.25f / 4);  // ((3 - 1) / (3 + 1))^2, s = 0
    extensions["KHR_materials_specular"] = {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0, 2}}};
    EXPECT_FLOAT_EQ(converted(material).specular.r, 0.125f / 4);
    EXPECT_EQ(converted(material).specular.g, 0);
    EXPECT_FLOAT_EQ(converted(material).specular.b, 0.25f / 4);
}

TEST(GltfMaterial, that_is_unlit_only_shines) {
    json material = pbr(0, 1);
    material["extensions"]["KHR_materials_unlit"] = json::object();
    const SceneMaterial m = converted(material);
    EXPECT_EQ(m.emission, color);
    EXPECT_EQ(m.diffuse, glm::vec3(0));
    EXPECT_EQ(m.specular, glm::vec3(0));
}

TEST(GltfMaterial, that_blends_is_see_through_and_one_that_does_not_ignores_its_alpha) {
    json material = pbr(0, 1);
    material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 1, 0.25};
    EXPECT_EQ(converted(material).transmission, 0);
    material["alphaMode"] = "BLEND";
    const SceneMaterial m = converted(material);
    EXPECT_EQ(m.transmission, 0.75f);
    EXPECT_EQ(m.ior, 1);
    EXPECT_EQ(m.base_color, glm::vec3(1));
}

TEST(GltfMaterial, of_specular_and_glossiness_keeps_both) {
    const SceneMaterial m = converted(
        {{"extensions",
          {{"KHR_materials_pbrSpecularGlossiness",
            {{"diffuseFactor", {0.5, 0.25, 1, 1}}, {"specularFactor", {0.2, 0.1, 0}}, {"glossinessFactor", 0}}}}}});
    EXPECT_EQ(m.diffuse, color);
    EXPECT_FLOAT_EQ(m.specular.r, 0.2f / 4);
    EXPECT_EQ(m.specular.b, 0);
}

/// A BMP of 2 x 2 pixels: blue, white over black, red.
std::string bmp() {
    std::string text = "BM";
    text += GltfDocument::number(70) + GltfDocument::number(0) + GltfDocument::number(54);
    for (const std::uint32_t n : {40u, 2u, 2u, 1u | 24u << 16, 0u, 16u, 0u, 0u, 0u, 0u})
        text += GltfDocument::number(n);
    const unsigned char rows[] = {0, 0, 0, 0, 0, 255, 0, 0, 255, 0, 0, 255, 255, 255, 0, 0};  // from the bottom, BGR
    return text + std::string(reinterpret_cast<const char*>(rows), sizeof rows);
}

GltfDocument with_texture() {
    GltfDocument document;
    document.json["images"][0]["uri"] = GltfDocument::data_uri(bmp());
    document.json["textures"][0]["source"] = 0;
    return document;
}

TEST(GltfMaterial, with_a_texture_has_it_the_right_way_up) {
    json material = pbr(0, 1);
    material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    const Scene scene = load_with(material, with_texture());
    const SceneMaterial& m = scene.materials.at(scene.triangles.at(0).material);
    ASSERT_EQ(m.diffuse_map, 0u);
    const std::vector<glm::vec3> texels = {{0, 0, 1}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0}};
    EXPECT_EQ(scene.images.at(0).texels, texels);
    EXPECT_EQ(m.ambient, color * glm::vec3(0.5f, 0.25f, 0.5f));  // the mean of the texels
    // glTF's uv (0, 0) is the top left corner of the picture, ours the bottom left one.
    const float* uv = scene.vertices[scene.triangles[0].vertex[0]].uv;
    EXPECT_EQ(glm::vec2(uv[0], uv[1]), glm::vec2(0, 1));
}

TEST(GltfMaterial, may_move_its_texture) {
    json material = pbr(0, 1);
    auto& info = material["pbrMetallicRoughness"]["baseColorTexture"];
    info["index"] = 0;
    info["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.5, 0.25}}, {"rotation", glm::half_pi<double>()}, {"scale", {2, 3}}};
    const Scene scene = load_with(material, with_texture());
    // (1, 0) is scaled to (2, 0), turned counter-clockwise where v points down to (0, -2), moved to (0.5, -1.75).
    const float* uv = scene.vertices[scene.triangles.at(0).vertex[1]].uv;
    EXPECT_NEAR(uv[0], 0.5, 1e-6);  // floats near 1
    EXPECT_NEAR(uv[1], 2.75, 1e-6);
}

TEST(GltfMaterial, with_a_texture_of_metal_and_roughness_has_their_means_and_says_so) {
    json material = {{"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", 0}}}}}};
    const Scene scene = load_with(material, with_texture());
    const SceneMaterial& m = scene.materials.at(scene.triangles.at(0).material);
    // Blue is 1 in two of four pixels, green in one: metallic 0.5, roughness 0.25.
    EXPECT_FLOAT_EQ(m.reflection, 0.5f * 0.75f * 0.75f);
    EXPECT_TRUE(warns_of(scene, "metallicRoughnessTexture"));
}

TEST(GltfMaterial, with_a_missing_picture_warns_and_with_a_damaged_one_is_refused) {
    json material = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
    GltfDocument missing = with_texture();
    missing.json["images"][0]["uri"] = "none.png";
    EXPECT_TRUE(warns_of(load_with(material, missing), "cannot read the texture"));
    GltfDocument damaged = with_texture();
    damaged.json["images"][0]["uri"] = GltfDocument::data_uri("nonsense");
    EXPECT_THROW(load_with(material, damaged), SceneError);
}

}  // namespace
}  // namespace raymill
