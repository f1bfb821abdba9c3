#include "scene/texture.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scene_files.hpp"

namespace raymill {
namespace {

std::string little_endian(std::uint32_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i);
    return text;
}

/// A 24-bit BMP; pixels row by row from the top, 0xrrggbb.
std::string bmp(std::uint32_t width, std::uint32_t height, const std::vector<std::uint32_t>& pixels) {
    const std::uint32_t row = (3 * width + 3) / 4 * 4;
    std::string text = "BM" + little_endian(54 + row * height, 4) + little_endian(0, 4) + little_endian(54, 4);
    text += little_endian(40, 4) + little_endian(width, 4) + little_endian(height, 4) + little_endian(1, 2) +
            little_endian(24, 2) + std::string(24, '\0');
    for (std::uint32_t y = height; y-- > 0;) {
        std::string line;
        for (std::uint32_t x = 0; x < width; ++x) line += little_endian(pixels[y * width + x], 3);
        line.resize(row);
        text += line;
    }
    return text;
}

TextureImage decode(const std::string& bytes) {
    std::size_t mended = 0;
    return decode_texture(bytes, "picture", mended);
}

TEST(Texture, of_eight_bits_is_decoded_from_srgb_row_by_row_from_the_top) {
    const TextureImage image = decode(bmp(2, 2, {0xff0000, 0x00ff00, 0x0000ff, 0xbc8000}));
    ASSERT_EQ(image.texels.size(), 4u);
    EXPECT_EQ(image.texels[0], glm::vec3(1, 0, 0));
    EXPECT_EQ(image.texels[1], glm::vec3(0, 1, 0));
    EXPECT_EQ(image.texels[2], glm::vec3(0, 0, 1));
    // IEC 61966-2-1 at 188 / 255 and 128 / 255; the values are given to seven digits.
    EXPECT_NEAR(image.texels[3].r, 0.5028865, 1e-6);
    EXPECT_NEAR(image.texels[3].g, 0.2158605, 1e-6);
}

TEST(Texture, of_radiance_hdr_is_linear_and_not_clamped) {
    // One flat RGBE pixel: (200, 100, 0) * 2^(132 - 136).
    const std::string hdr =
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n") + "\xc8\x64" + '\0' + "\x84";
    const TextureImage image = decode(hdr);
    ASSERT_EQ(image.texels.size(), 1u);
    EXPECT_EQ(image.texels[0], glm::vec3(12.5f, 6.25f, 0));
}

std::string exr(const SceneFiles& files, const std::vector<std::string>& channels, const std::vector<float>& values) {
    const Imath::Box2i window({3, -2}, {4, -1});  // away from the origin
    Imf::Header header(Imath::Box2i({0, 0}, {9, 9}), window);
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        header.channels().insert(channels[c], Imf::Channel(Imf::FLOAT));
        char* base = reinterpret_cast<char*>(const_cast<float*>(values.data() + 4 * c));
        frame.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, base, window, sizeof(float), 2 * sizeof(float)));
    }
    const std::string file = files.path("a.exr");
    {
        Imf::OutputFile output(file.c_str(), header);
        output.setFrameBuffer(frame);
        output.writePixels(2);
    }
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Texture, of_openexr_holds_the_data_window_in_full_precision) {
    const SceneFiles files;
    const TextureImage image =
        decode(exr(files, {"B", "G", "R"}, {1, 2, 3, 4, 10, 20, 30, 40, 0.1f, 1e6f, 1e-6f, 400}));
    ASSERT_EQ(image.width, 2u);
    ASSERT_EQ(image.height, 2u);
    EXPECT_EQ(image.texels[0], glm::vec3(0.1f, 10, 1));
    EXPECT_EQ(image.texels[1], glm::vec3(1e6f, 20, 2));
    EXPECT_EQ(image.texels[3], glm::vec3(400, 40, 4));
}

TEST(Texture, of_grey_openexr_is_grey) {
    const SceneFiles files;
    EXPECT_EQ(decode(exr(files, {"Y"}, {1, 2, 3, 4})).texels[2], glm::vec3(3));
}

TEST(Texture, counts_and_mends_values_that_are_no_light) {
    const SceneFiles files;
    std::size_t mended = 0;
    const TextureImage image = decode_texture(exr(files, {"Y"}, {NAN, INFINITY, -1, 4}), "picture", mended);
    EXPECT_EQ(mended, 9u);
    EXPECT_EQ(image.texels[0], glm::vec3(0));
    EXPECT_EQ(image.texels[3], glm::vec3(4));
}

TEST(Texture, that_is_larger_than_its_bytes_can_say_is_refused) {
    std::string lie = bmp(2, 2, {0, 0, 0, 0});
    lie.replace(18, 8, little_endian(65535, 4) + little_endian(65535, 4));
    EXPECT_THROW(decode(lie), std::runtime_error);
    EXPECT_THROW(decode("not a picture"), std::runtime_error);
    EXPECT_THROW(decode(""), std::runtime_error);
}

constexpr const char* textured =
    "[[material]]\nname = 'a'\ndiffuse_map = 'a.bmp'\n[[material]]\nname = 'b'\ndiffuse = 0.5\n"
    "diffuse_map = 'a.bmp'\n";

TEST(Texture, of_two_materials_is_loaded_once_and_multiplies_diffuse) {
    const SceneFiles files;
    files.write("a.bmp", bmp(1, 1, {0xffffff}));
    const Scene scene = files.toml(textured);
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.materials[1].diffuse_map, 0u);
    EXPECT_EQ(scene.materials[2].diffuse_map, 0u);
    EXPECT_EQ(scene.materials[1].diffuse, glm::vec3(1));  // a picture alone is shown as it is
    EXPECT_EQ(scene.materials[2].diffuse, glm::vec3(0.5f));
    EXPECT_EQ(scene.images[0].file, files.path("a.bmp"));
}

TEST(Texture, that_is_damaged_is_an_error_with_its_name) {
    const SceneFiles files;
    files.write("a.bmp", bmp(4, 4, std::vector<std::uint32_t>(16)).substr(0, 40));
    const auto faults = files.faults(textured);
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_THAT(faults[0], testing::StartsWith("3:15: cannot decode the texture \"" + files.path("a.bmp") + "\": "));
}

TEST(Texture, of_an_mtl_is_its_diffuse_map) {
    const SceneFiles files;
    files.write("a b.bmp", bmp(1, 1, {0xffffff}));
    files.write("a.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd a b.bmp\n");
    const Scene scene = files.obj("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    EXPECT_EQ(scene.materials.at(1).diffuse_map, 0u);
    EXPECT_EQ(scene.materials.at(1).diffuse, glm::vec3(0.5f));
}

TEST(Texture, of_the_environment_is_loaded) {
    const SceneFiles files;
    files.write("sky.bmp", bmp(2, 1, {0xffffff, 0}));
    const Scene scene = files.toml("[[light]]\ntype = 'environment'\nmap = 'sky.bmp'\n");
    const auto& light = std::get<EnvironmentLight>(scene.lights[0].light);
    EXPECT_EQ(light.map, 0u);
    EXPECT_EQ(light.radiance, glm::vec3(1));
}

}  // namespace
}  // namespace raymill
