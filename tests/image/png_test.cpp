// PNG output: the sRGB transfer function, exposure, and what a decoder sees.
#include <gtest/gtest.h>
#include <png.h>

#include <bit>
#include <cmath>
#include <limits>

#include "image/image.hpp"
#include "image/srgb.hpp"
#include "temporary_folder.hpp"

namespace raymill {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// The linear value of a code that lies anywhere in [0, 255]: the inverse of the function under test, from the
/// standard.
double linear_of(double code) {
    const double encoded = code / 255;
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

struct Decoded {
    png_uint_32 width = 0;
    png_uint_32 height = 0;
    std::vector<std::uint8_t> rgba;
};

Decoded decode(const std::string& file) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&png, file.c_str()), 0) << png.message;
    EXPECT_EQ(png.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
    png.format = PNG_FORMAT_RGBA;
    Decoded decoded{png.width, png.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
    EXPECT_NE(png_image_finish_read(&png, nullptr, decoded.rgba.data(), 0, nullptr), 0) << png.message;
    return decoded;
}

TEST(srgb_code, gives_back_each_of_the_256_codes) {
    for (int code = 0; code < 256; ++code) EXPECT_EQ(srgb_code(linear_of(code)), code);
}

// A thousandth of a code is far above the rounding of doubles and of the standard's constants (1e-5 codes at the seam).
TEST(srgb_code, changes_halfway_between_codes) {
    for (int code = 0; code < 255; ++code) {
        EXPECT_EQ(srgb_code(linear_of(code + 0.499)), code);
        EXPECT_EQ(srgb_code(linear_of(code + 0.501)), code + 1);
    }
}

TEST(srgb_code, clamps_and_turns_nan_black) {
    EXPECT_EQ(srgb_code(-0.0), 0);
    EXPECT_EQ(srgb_code(-1e30), 0);
    EXPECT_EQ(srgb_code(-infinity), 0);
    EXPECT_EQ(srgb_code(1 + 1e-7), 255);
    EXPECT_EQ(srgb_code(infinity), 255);
    EXPECT_EQ(srgb_code(nan), 0);
}

TEST(SrgbEncoder, agrees_where_codes_change_and_everywhere_between) {
    const SrgbEncoder srgb;
    const auto expect_alike = [&](float linear) { EXPECT_EQ(srgb.code(linear), srgb_code(linear)) << linear; };
    for (int code = 0; code < 255; ++code) {
        auto least = static_cast<float>(linear_of(code + 0.5));
        for (int step = 0; step < 4; ++step) least = std::nextafter(least, 0.0f);
        for (int step = 0; step < 8; ++step, least = std::nextafter(least, 2.0f)) expect_alike(least);
    }
    for (std::uint32_t bits = 0; bits < std::bit_cast<std::uint32_t>(2.0f); bits += 4099)
        expect_alike(std::bit_cast<float>(bits));
    for (const float linear : {0.0f, -0.0f, -1.0f, 1.0f, infinity, -infinity, nan}) expect_alike(linear);
    expect_alike(std::nextafter(1.0f, 0.0f));
    expect_alike(std::numeric_limits<float>::denorm_min());
}

TEST(write_png, a_decoder_sees_the_pixels_in_order_and_opaque) {
    const TemporaryFolder folder;
    const Image image{
        3, 2, {0, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0.5f, 0, 0, 1, -1, 2, nan, -3, nan, 0.5f, 0.25f, infinity, 7}};
    write_png(folder.file("a.png"), image, 0);
    const Decoded decoded = decode(folder.file("a.png"));
    EXPECT_EQ(decoded.width, 3u);
    EXPECT_EQ(decoded.height, 2u);
    // 188 and 137 are the codes of a half and a quarter: 255 * 0.7354 and 255 * 0.5371.
    const std::vector<std::uint8_t> expected = {0, 0, 0,   255, 255, 0, 0, 255, 0,   255, 0,   255,
                                                0, 0, 255, 255, 255, 0, 0, 255, 188, 137, 255, 255};
    EXPECT_EQ(decoded.rgba, expected);
}

TEST(write_png, exposure_scales_by_powers_of_two_before_encoding) {
    const TemporaryFolder folder;
    for (const double stops : {-3.0, -0.5, 0.0, 1.0, 2.5}) {
        const Image image{1, 1, {0.1f, 0.02f, 0.7f, 1}};
        write_png(folder.file("a.png"), image, stops);
        const Decoded decoded = decode(folder.file("a.png"));
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(decoded.rgba[i], srgb_code(std::pow(2.0, stops) * double{image.rgba[i]})) << stops;
    }
    const Image image{1, 1, {0.25f, 0.5f, 1, 1}};
    write_png(folder.file("a.png"), image, 1);
    EXPECT_EQ(decode(folder.file("a.png")).rgba, (std::vector<std::uint8_t>{188, 255, 255, 255}));
}

TEST(write_png, an_exposure_beyond_all_numbers_gives_white_and_black) {
    const TemporaryFolder folder;
    write_png(folder.file("a.png"), Image{1, 1, {1e-30f, 0, -1, 1}}, 1e6);
    EXPECT_EQ(decode(folder.file("a.png")).rgba, (std::vector<std::uint8_t>{255, 0, 0, 255}));
    write_png(folder.file("b.png"), Image{1, 1, {1e10f, -1e10f, nan, 1}}, 100);  // beyond floats, not beyond doubles
    EXPECT_EQ(decode(folder.file("b.png")).rgba, (std::vector<std::uint8_t>{255, 0, 0, 255}));
}

TEST(write_png, declares_srgb) {
    const TemporaryFolder folder;
    write_png(folder.file("a.png"), Image{1, 1, {0, 0, 0, 1}}, 0);
    EXPECT_NE(read_bytes(folder.file("a.png")).find("sRGB"), std::string::npos);
}

}  // namespace
}  // namespace raymill
