// Captures on disk: what is read back, and what is refused.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstring>

#include "capture/capture_file.hpp"
#include "captured.hpp"
#include "common/error.hpp"
#include "image/temporary_folder.hpp"
#include "support/queues.hpp"

namespace raymill::capture {
namespace {

/// Every field with a value of its own; a few hundred bytes as a file.
Capture small_capture() {
    Capture c;
    c.frame.scene_file = "/scenes/a b.toml";
    c.frame.scene_hash = 0x123456789abcdef0u;
    c.frame.width = 24;
    c.frame.height = 18;
    c.frame.spp = 2;
    c.frame.depth = 3;
    c.frame.seed = 99;
    c.frame.crop = {0.125, 0.5, 0.25, 0.75};
    c.frame.planes.keep(FILM_NORMAL);
    c.stage = Stage::shade;
    c.depth = 1;
    c.launch = 4;
    c.count = 2;
    c.first_sample = 6;
    c.slots = {4, 2};
    c.rays = {test::make_ray({1, 2, 3}, {0, 0, 1}, 5), test::make_ray({4, 5, 6}, {0, 1, 0}, 6)};
    c.hits = {{1.5f, 0.25f, 0.5f, 3}, {2.5f, 0, 0, NO_INDEX}};
    c.shadow_rays.resize(1);
    c.shadow_rays[0].pixel = 17;
    c.shadow_counts = {0, 1};
    c.digest = {11, 12};
    return c;
}

class CaptureFile : public testing::Test {
  protected:
    CaptureFile() { write_capture(file_, small_capture()); }

    /// The sentence with which the bytes are refused; empty, and the test fails, if they are not.
    std::string refusal(const std::string& bytes) {
        write_text(file_, bytes);
        try {
            read_capture(file_);
        } catch (const UsageError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with(file_ + ": ")) << error.what();
            return error.what();
        }
        ADD_FAILURE() << "was read";
        return "";
    }
    void expect_refusal(const std::string& bytes, const std::string& reason) {
        const std::string message = refusal(bytes);
        EXPECT_NE(message.find(reason), std::string::npos) << message << "\nwithout: " << reason;
    }

    const TemporaryFolder folder_;
    const std::string file_ = folder_.file("queue.wave");
};

TEST_F(CaptureFile, gives_back_every_field) {
    const Capture expected = small_capture(), c = read_capture(file_);
    EXPECT_EQ(c.frame.scene_file, expected.frame.scene_file);
    EXPECT_EQ(c.frame.scene_hash, expected.frame.scene_hash);
    EXPECT_EQ(c.frame.width, 24);
    EXPECT_EQ(c.frame.height, 18);
    EXPECT_EQ(c.frame.spp, 2);
    EXPECT_EQ(c.frame.depth, 3);
    EXPECT_EQ(c.frame.seed, 99u);
    EXPECT_EQ(c.frame.crop.x0, 0.125);
    EXPECT_EQ(c.frame.crop.x1, 0.5);
    EXPECT_EQ(c.frame.crop.y0, 0.25);
    EXPECT_EQ(c.frame.crop.y1, 0.75);
    for (int plane = 0; plane < FILM_PLANES; ++plane)
        EXPECT_EQ(c.frame.planes.keeps(plane), expected.frame.planes.keeps(plane)) << plane;
    EXPECT_EQ(c.stage, Stage::shade);
    EXPECT_EQ(c.depth, 1);
    EXPECT_EQ(c.launch, 4u);
    EXPECT_EQ(c.count, 2u);
    EXPECT_EQ(c.first_sample, 6u);
    EXPECT_EQ(c.slots.first, 4u);
    EXPECT_EQ(c.slots.count, 2u);
    EXPECT_EQ(bytes_of(c.rays), bytes_of(expected.rays));
    EXPECT_EQ(bytes_of(c.hits), bytes_of(expected.hits));
    EXPECT_EQ(bytes_of(c.shadow_rays), bytes_of(expected.shadow_rays));
    EXPECT_EQ(c.shadow_counts, expected.shadow_counts);
    EXPECT_EQ(c.digest, expected.digest);
}

TEST_F(CaptureFile, that_is_cut_off_anywhere_is_refused) {
    const std::string bytes = read_bytes(file_);
    ASSERT_GT(bytes.size(), 200u);
    for (std::size_t length = 0; length < bytes.size(); ++length)
        EXPECT_NE(refusal(bytes.substr(0, length)), "") << length;
    expect_refusal(bytes.substr(0, bytes.size() - 1), "cut off");
    expect_refusal(bytes.substr(0, 5), "cut off");
    expect_refusal("", "no captured queue");
}

TEST_F(CaptureFile, with_any_bit_flipped_is_refused) {
    const std::string bytes = read_bytes(file_);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        std::string flipped = bytes;
        flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
        EXPECT_NE(refusal(flipped), "") << "bit " << bit;
    }
    std::string flipped = bytes;
    flipped.back() = static_cast<char>(flipped.back() ^ 1);
    expect_refusal(flipped, "damaged");
}

TEST_F(CaptureFile, that_goes_on_is_refused) {
    expect_refusal(read_bytes(file_) + "x", "followed by something else");
}

TEST_F(CaptureFile, that_is_foreign_is_refused) {
    expect_refusal("v 0 0 0\nf 1 1 1\n", "no captured queue");
    expect_refusal(std::string(1000, '\0'), "no captured queue");
}

TEST_F(CaptureFile, of_another_version_is_refused_by_both_numbers) {
    std::string bytes = read_bytes(file_);
    bytes[8] = 7;
    expect_refusal(bytes, fmt::format("version 7, and this program reads version {}", format_version));
}

/// The file's bytes with other ones at a place behind the header, and the checksum that belongs to them.
std::string with_payload(std::string bytes, std::size_t place, const std::string& other) {
    constexpr std::size_t header = 28;
    bytes.replace(header + place, other.size(), other);
    std::uint64_t checksum = 0xcbf29ce484222325u;
    for (const char byte : bytes.substr(header))
        checksum = (checksum ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
    const std::uint64_t size = bytes.size() - header;
    std::memcpy(bytes.data() + 12, &size, sizeof size);
    std::memcpy(bytes.data() + 20, &checksum, sizeof checksum);
    return bytes;
}

TEST_F(CaptureFile, of_another_layout_is_refused) {
    const std::string bytes = read_bytes(file_);
    ASSERT_EQ(with_payload(bytes, 0, ""), bytes);
    for (const std::size_t place : {0, 8, 12, 16, 20})  // hash, bytes of ray, hit and shadow ray, CHUNK
        expect_refusal(with_payload(bytes, place, std::string(1, '\x7f')), "another layout");
}

TEST_F(CaptureFile, whose_lists_claim_more_than_is_there_is_refused) {
    // The first length, that of the scene's path, follows the layout.
    const std::string bytes = read_bytes(file_);
    expect_refusal(with_payload(bytes, 24, std::string(8, '\xff')), "its lists do not fill it");
    expect_refusal(with_payload(bytes, 24, std::string(8, '\0')), "its lists do not fill it");
}

TEST_F(CaptureFile, that_is_not_there_or_no_file_is_refused) {
    EXPECT_THROW(read_capture(folder_.file("nothing")), UsageError);
    EXPECT_THROW(read_capture(folder_.path().string()), UsageError);
}

class Fits : public testing::TestWithParam<Stage> {};

TEST_P(Fits, what_was_captured_and_nothing_that_leads_out_of_a_buffer) {
    TestFrame frame(branching_scene());
    const Stage stage = GetParam();
    const Capture good = capture_of(frame, stage, 0);
    ASSERT_TRUE(fits(good, frame.scene));
    const auto expect_misfit = [&](const char* what, const auto& spoil) {
        Capture bad = good;
        spoil(bad);
        EXPECT_FALSE(fits(bad, frame.scene)) << what;
    };
    const uint pixels = 24 * 18;
    expect_misfit("stage", [](Capture& c) { c.stage = Stage::resolve; });
    expect_misfit("too deep", [](Capture& c) { c.depth = 4; });
    expect_misfit("light samples", [](Capture& c) { c.slots = {6, 1}; });
    expect_misfit("many light samples", [](Capture& c) { c.slots.count = SHADOW_SAMPLES + 1; });
    if (stage == Stage::generate) {
        expect_misfit("samples", [&](Capture& c) { c.first_sample = 2 * pixels - c.count + 1; });
        expect_misfit("stray rays", [](Capture& c) { c.rays.resize(c.count); });
    }
    if (!good.rays.empty()) {
        expect_misfit("pixel", [&](Capture& c) { c.rays.back().pixel = pixels; });
        expect_misfit("route", [](Capture& c) { c.rays.back().route = ROUTE_REFRACTED + 1; });
        expect_misfit("missing ray", [](Capture& c) { c.rays.pop_back(); });
    }
    if (!good.hits.empty()) {
        expect_misfit("primitive", [&](Capture& c) { c.hits.back().primitive = frame.scene.primitive_count(); });
        expect_misfit("missing hit", [](Capture& c) { c.hits.pop_back(); });
    }
    if (!good.shadow_rays.empty()) {
        expect_misfit("shadow pixel", [&](Capture& c) { c.shadow_rays.back().pixel = pixels; });
        expect_misfit("missing segment", [](Capture& c) { c.shadow_counts.pop_back(); });
        expect_misfit("missing shadow ray", [](Capture& c) { c.shadow_rays.pop_back(); });
        expect_misfit("overfull segment", [](Capture& c) {
            c.shadow_counts = std::vector<uint>(c.shadow_counts.size(), 0);
            c.shadow_counts[0] = CHUNK + 1;
            c.shadow_rays.resize(CHUNK + 1);
        });
    }
}

INSTANTIATE_TEST_SUITE_P(Stages, Fits, testing::ValuesIn(stages), [](const auto& info) { return name_of(info.param); });

}  // namespace
}  // namespace raymill::capture
