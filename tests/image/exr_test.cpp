// EXR output, read back by OpenEXR: every bit of the pixels, both windows, all attributes.
#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>

#include "image/image.hpp"
#include "temporary_folder.hpp"

namespace raymill {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float largest_half = 65504;

ImageMetadata metadata_of(const Image& image) {
    ImageMetadata metadata;
    metadata.full_width = image.width;
    metadata.full_height = image.height;
    return metadata;
}

/// The pixels of the data window as floats, whatever the file holds; OpenEXR widens halfs exactly.
std::vector<float> read_pixels(const std::string& file) {
    Imf::InputFile input(file.c_str());
    const Imath::Box2i window = input.header().dataWindow();
    const auto width = static_cast<std::size_t>(window.size().x + 1);
    const auto height = static_cast<std::size_t>(window.size().y + 1);
    std::vector<float> rgba(4 * width * height);
    Imf::FrameBuffer frame_buffer;
    for (std::size_t i = 0; i < 4; ++i)
        frame_buffer.insert(std::string(1, "RGBA"[i]),
                            Imf::Slice::Make(Imf::FLOAT, rgba.data() + i, window, 4 * sizeof(float)));
    input.setFrameBuffer(frame_buffer);
    input.readPixels(window.min.y, window.max.y);
    return rgba;
}

std::vector<float> round_trip(const std::vector<float>& values, ExrPixels pixels) {
    const TemporaryFolder folder;
    Image image{static_cast<int>((values.size() + 3) / 4), 1, values};
    image.rgba.resize(4 * static_cast<std::size_t>(image.width));
    write_exr(folder.file("a.exr"), image, {}, metadata_of(image), pixels);
    std::vector<float> read = read_pixels(folder.file("a.exr"));
    read.resize(values.size());
    return read;
}

/// A file of one grey pixel.
Imf::Header header_of(const ImageMetadata& metadata, ExrPixels pixels = ExrPixels::float32) {
    const TemporaryFolder folder;
    write_exr(folder.file("a.exr"), Image{1, 1, {1, 1, 1, 1}}, {}, metadata, pixels);
    return Imf::InputFile(folder.file("a.exr").c_str()).header();
}

ImageMetadata one_pixel() {
    return metadata_of(Image{1, 1, {}});
}

TEST(write_exr, floats_keep_every_bit) {
    const std::vector<float> values = {0.0f,     -0.0f,  1e-30f, -1e-30f,  65504.0f,
                                       65520.0f, 1e30f,  -1e30f, infinity, -infinity,
                                       nan,      1e-45f, 0.1f,   1.0f / 3, std::nextafter(1.0f, 2.0f),
                                       FLT_MAX,  FLT_MIN};
    const std::vector<float> read = round_trip(values, ExrPixels::float32);
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_EQ(std::bit_cast<std::uint32_t>(read[i]), std::bit_cast<std::uint32_t>(values[i])) << values[i];
}

TEST(write_exr, halfs_keep_every_value_that_is_a_half) {
    std::vector<float> values;
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const Imath::half value(Imath::half::FromBits, static_cast<std::uint16_t>(bits));
        if (!value.isNan()) values.push_back(value);
    }
    const std::vector<float> read = round_trip(values, ExrPixels::half16);
    for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(read[i]), std::bit_cast<std::uint32_t>(values[i])) << values[i];
    EXPECT_TRUE(std::isnan(round_trip({nan}, ExrPixels::half16)[0]));
}

// The middle of two neighbouring halfs is exact in float, so both it and its float neighbours have one right answer.
TEST(write_exr, halfs_round_to_nearest_with_ties_to_even) {
    std::vector<float> values;
    std::vector<float> expected;
    for (std::uint16_t bits = 0; bits < 0x7bff; ++bits) {  // up to the largest finite half
        const float low = Imath::half(Imath::half::FromBits, bits);
        const float high = Imath::half(Imath::half::FromBits, static_cast<std::uint16_t>(bits + 1));
        const float middle = low + (high - low) / 2;
        values.insert(values.end(), {std::nextafter(middle, 0.0f), middle, -std::nextafter(middle, infinity)});
        expected.insert(expected.end(), {low, bits % 2 == 0 ? low : high, -high});
    }
    const std::vector<float> read = round_trip(values, ExrPixels::half16);
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(read[i], expected[i]) << values[i];
}

TEST(write_exr, a_finite_value_never_becomes_an_infinite_half) {
    const std::vector<float> values = {65519.996f, 65520.0f, 1e30f, FLT_MAX, -65520.0f, -1e30f, infinity, -infinity};
    const std::vector<float> expected = {largest_half,  largest_half,  largest_half, largest_half,
                                         -largest_half, -largest_half, infinity,     -infinity};
    EXPECT_EQ(round_trip(values, ExrPixels::half16), expected);
}

TEST(write_exr, rows_run_from_the_top_left) {
    const TemporaryFolder folder;
    Image image{5, 40, {}};  // more than the 16 rows of a compressed block
    for (int i = 0; i < 4 * 5 * 40; ++i) image.rgba.push_back(static_cast<float>(i));
    write_exr(folder.file("a.exr"), image, {}, metadata_of(image), ExrPixels::float32);
    EXPECT_EQ(read_pixels(folder.file("a.exr")), image.rgba);
}

TEST(write_exr, a_crop_lies_in_the_data_window_of_the_whole_image) {
    const TemporaryFolder folder;
    Image image{3, 2, std::vector<float>(24)};
    for (std::size_t i = 0; i < 24; ++i) image.rgba[i] = static_cast<float>(i);
    ImageMetadata metadata;
    metadata.full_width = 640;
    metadata.full_height = 480;
    metadata.x0 = 100;
    metadata.y0 = 478;
    for (const ExrPixels pixels : {ExrPixels::float32, ExrPixels::half16}) {
        write_exr(folder.file("a.exr"), image, {}, metadata, pixels);
        const Imf::Header header = Imf::InputFile(folder.file("a.exr").c_str()).header();
        EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {639, 479}));
        EXPECT_EQ(header.dataWindow(), Imath::Box2i({100, 478}, {102, 479}));
        EXPECT_EQ(read_pixels(folder.file("a.exr")), image.rgba);  // small integers are exact halfs
    }
}

TEST(write_exr, has_the_channels_r_g_b_a_of_the_type_asked_for) {
    for (const auto& [pixels, type] : {std::pair{ExrPixels::float32, Imf::FLOAT}, {ExrPixels::half16, Imf::HALF}}) {
        const Imf::Header header = header_of(one_pixel(), pixels);
        std::string names;
        for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
            names += channel.name();
            EXPECT_EQ(channel.channel().type, type);
        }
        EXPECT_EQ(names, "ABGR");  // OpenEXR sorts channels by name
        EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    }
}

TEST(write_exr, the_header_tells_what_made_the_picture) {
    ImageMetadata metadata = one_pixel();
    metadata.samples_per_pixel = 1024;
    metadata.render_seconds = 12.625;
    metadata.scene_hash = 0x0123456789abcdef;
    metadata.scene_file = "scenes/a b.toml";
    metadata.version = "1.2.3";
    const Imf::Header header = header_of(metadata);
    EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("raymill:samplesPerPixel").value(), 1024);
    EXPECT_EQ(header.typedAttribute<Imf::FloatAttribute>("raymill:renderTime").value(), 12.625f);
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("raymill:sceneHash").value(), "0123456789abcdef");
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("raymill:scene").value(), "scenes/a b.toml");
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("raymill:version").value(), "1.2.3");
    const Imf::Chromaticities primaries = header.typedAttribute<Imf::ChromaticitiesAttribute>("chromaticities").value();
    EXPECT_EQ(primaries.red, Imath::V2f(0.64f, 0.33f));  // Rec. 709
    EXPECT_EQ(primaries.white, Imath::V2f(0.3127f, 0.329f));
}

// All numbers are small integers, so every product is exact.
TEST(write_exr, its_matrices_transform_points_as_the_given_ones_do) {
    ImageMetadata metadata = one_pixel();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            metadata.world_to_camera[column][row] = row < 3 ? 3 * column + row * row + 1 : column == 3;
            metadata.world_to_ndc[column][row] = column + 5 * row - 7;
        }
    const Imf::Header header = header_of(metadata);
    for (const auto& [name, given] :
         {std::pair{"worldToCamera", metadata.world_to_camera}, std::pair{"worldToNDC", metadata.world_to_ndc}}) {
        const Imath::M44f stored = header.typedAttribute<Imf::M44fAttribute>(name).value();
        const glm::dvec4 expected = given * glm::dvec4(2, -3, 5, 1);
        const Imath::V4f found = Imath::V4f(2, -3, 5, 1) * stored;
        for (int i = 0; i < 4; ++i) EXPECT_EQ(double{found[i]}, expected[i]) << name << ' ' << i;
    }
}

TEST(write_exr, files_of_two_runs_differ_in_the_render_time_alone) {
    const TemporaryFolder folder;
    const Image image{2, 2, std::vector<float>(16, 0.3f)};
    ImageMetadata metadata = metadata_of(image);
    metadata.render_seconds = 1;
    write_exr(folder.file("a.exr"), image, {}, metadata, ExrPixels::float32);
    metadata.render_seconds = 2;
    write_exr(folder.file("b.exr"), image, {}, metadata, ExrPixels::float32);
    const std::string a = read_bytes(folder.file("a.exr"));
    std::string b = read_bytes(folder.file("b.exr"));
    ASSERT_EQ(a.size(), b.size());
    ASSERT_NE(a, b);
    const std::string attribute("raymill:renderTime\0float\0\4\0\0\0", 29);  // name, type, size in bytes
    const std::size_t value = a.find(attribute) + attribute.size();
    ASSERT_GE(value, attribute.size());
    b.replace(value, 4, a, value, 4);
    EXPECT_EQ(a, b);
}

TEST(write_exr, writes_the_same_file_by_any_number_of_threads) {
    const TemporaryFolder folder;
    Image image{37, 101, {}};  // blocks of sixteen lines, the last one shorter
    for (int i = 0; i < 4 * 37 * 101; ++i) image.rgba.push_back(std::sin(0.1f * static_cast<float>(i)));
    std::vector<std::string> files;
    for (const unsigned threads : {1u, 2u, 7u, 0u}) {
        write_exr(folder.file("a.exr"), image, {}, metadata_of(image), ExrPixels::float32, threads);
        files.push_back(read_bytes(folder.file("a.exr")));
    }
    EXPECT_EQ(read_pixels(folder.file("a.exr")), image.rgba);
    for (const std::string& file : files) EXPECT_TRUE(file == files.front());
}

TEST(write_exr, leaves_nothing_beside_the_file) {
    const TemporaryFolder folder;
    const Image image{1, 1, {1, 2, 3, 4}};
    write_exr(folder.file("a.exr"), image, {}, metadata_of(image), ExrPixels::float32);
    write_exr(folder.file("a.exr"), image, {}, metadata_of(image), ExrPixels::half16);
    EXPECT_EQ(folder.entries(), 1);
}

TEST(write_exr, a_missing_folder_is_an_output_error) {
    const TemporaryFolder folder;
    const Image image{1, 1, {1, 2, 3, 4}};
    EXPECT_THROW(write_exr(folder.file("no/a.exr"), image, {}, metadata_of(image), ExrPixels::float32), OutputError);
    EXPECT_THROW(write_png(folder.file("no/a.png"), image, 0), OutputError);
    EXPECT_EQ(folder.entries(), 0);
}

}  // namespace
}  // namespace raymill
