// Flags: what they accept, what they refuse, and what they do to the picture.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "exr_pixels.hpp"
#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

class Flags : public testing::Test {
  protected:
    Flags() { write_text(scene_, small_scene()); }

    Outcome check(std::vector<std::string> flags) {
        flags.insert(flags.begin(), {"check", scene_});
        return run_raymill(flags);
    }
    Picture render(const std::vector<std::string>& flags) {
        std::vector<std::string> arguments = {"render", scene_, "-o", folder_.file("picture.exr")};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        const Outcome outcome = run_raymill(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        return read_picture(folder_.file("picture.exr"));
    }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.file("scene.toml");
};

TEST_F(Flags, say_how_long_to_build_the_hierarchy) {
    for (const char* quality : {"fast", "high"}) {
        const Outcome outcome = check({"--bvh", quality});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.out, " bytes a primitive, ")) << outcome.out;
    }
}

TEST_F(Flags, that_make_no_sense_are_refused_by_name) {
    const std::vector<std::vector<std::string>> senseless = {
        {"--size", "640"},         {"--size", "0x10"},        {"--size", "10x-1"},    {"--size", "8x8x8"},
        {"--size", "99999x1"},     {"--size", "ax8"},         {"--size", "8.5x8"},    {"--crop", "0,1,0"},
        {"--crop", "0,1,0,2"},     {"--crop", "0.5,0.5,0,1"}, {"--crop", "1,0,0,1"},  {"--crop", "a,1,0,1"},
        {"--crop", "nan,1,0,1"},   {"--mem-limit", "lots"},   {"--mem-limit", "12Q"}, {"--mem-limit", "0"},
        {"--mem-limit", "-5M"},    {"--mem-limit", ""},       {"--spp", "0"},         {"--depth", "-1"},
        {"--queue-capacity", "0"}, {"--work-group", "0"},     {"--threads", "0"},     {"--integrator", "magic"},
        {"--exposure", "inf"},     {"--seed", "-1"},          {"--bvh", "best"},      {"--bvh", ""},
        {"--pipelines", "0"},      {"--pipelines", "17"}};
    for (const auto& flag : senseless) {
        SCOPED_TRACE(flag[0] + " '" + flag[1] + "'");
        // With an equals sign, so that a value that begins with a minus is one.
        expect_failure(check({flag[0] + "=" + flag[1]}), 2, flag[0]);
    }
}

TEST_F(Flags, of_the_device_that_make_no_sense_are_refused_by_name_and_say_what_would) {
    for (const char* flag : {"--queue-capacity", "--work-group", "--threads"})
        for (const char* text : {"0", "-1", "1k,2k", "1.5k", "1kk", "k", "16q", "lots", "0x10", "+4", " 4", "512M",
                                 "18446744073709551615k"}) {
            SCOPED_TRACE(std::string(flag) + " '" + text + "'");
            const Outcome outcome = check({std::string(flag) + "=" + text});
            expect_failure(outcome, 2, std::string(flag) + " " + text + ": give a number from 1 to ");
            EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
        }
    expect_failure(check({"--queue-capacity="}), 2, "--queue-capacity");
    expect_failure(check({"--queue-capacity", "auto"}), 2, "--queue-capacity");
    expect_failure(check({"--work-group", "lots"}), 2, " or auto, ");
    expect_failure(check({"--threads", "auto"}), 2, " or all, ");
}

TEST_F(Flags, of_the_device_take_the_units_and_words_of_profile) {
    const std::string stats = folder_.file("stats.json");
    const auto run = [&](const std::string& capacity, const std::string& work_group, const std::string& threads) {
        const Outcome outcome =
            run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--stats-json", stats, "--queue-capacity",
                         capacity, "--work-group", work_group, "--threads", threads});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return nlohmann::json::parse(read_bytes(stats)).at("run");
    };
    const auto in_thousands = run("16k", "auto", "1");
    EXPECT_EQ(in_thousands.at("queue_capacity"), 16384);
    EXPECT_EQ(in_thousands.at("work_group"), 0);
    EXPECT_EQ(in_thousands.at("compute_units"), 1);
    const auto all = run("1m", "8", "all");
    EXPECT_EQ(all.at("queue_capacity"), 1 << 20);
    EXPECT_EQ(all.at("work_group"), 8);
    const auto one = run("64", "auto", "all");
    render({"--stats-json", stats, "--queue-capacity", "64", "--pipelines", "4"});  // is timed wave by wave
    EXPECT_EQ(nlohmann::json::parse(read_bytes(stats)).at("run").at("device_bytes"), one.at("device_bytes"));
    render({"--stats-json", stats});
    EXPECT_EQ(all.at("compute_units"), nlohmann::json::parse(read_bytes(stats)).at("run").at("compute_units"));
    EXPECT_TRUE(contains(check({"--depth", "0", "--queue-capacity", "2K"}).out,
                         "\n            1 ray queues for batches of 2048 rays"));
    const std::vector<std::string> small = {"--depth", "0", "--queue-capacity", "64"};
    EXPECT_TRUE(contains(check(small).out, "\n            2 times 1 ray queues for batches of 64 rays"));
    EXPECT_TRUE(
        contains(check({"--depth=0", "--queue-capacity=64", "--pipelines=1"}).out, "\n            1 ray queues for"));
    EXPECT_TRUE(contains(check({"--depth=0", "--queue-capacity=64", "--pipelines=4"}).out,
                         "\n            4 times 1 ray queues for"));
}

TEST_F(Flags, say_the_size) {
    const Outcome outcome = check({"--size", "31x17", "--spp", "3", "--depth", "2"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "31 x 17 pixels, 3 spp, depth 2")) << outcome.out;
    const Picture picture = render({"--size", "31x17", "--spp", "3"});
    EXPECT_EQ(picture.width, 31);
    EXPECT_EQ(picture.height, 17);
    EXPECT_EQ(picture.header.typedAttribute<Imf::IntAttribute>("raymill:samplesPerPixel").value(), 3);
}

TEST_F(Flags, say_the_memory_with_and_without_units) {
    for (const char* size : {"1000000", "1M", "1MiB", "1MB", "0.5G", "1T"}) {
        const Outcome outcome = check({"--mem-limit", size});
        EXPECT_EQ(outcome.status, 0) << size << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.out, "memory")) << outcome.out;
    }
    const Outcome too_small = check({"--mem-limit", "1K"});
    EXPECT_EQ(too_small.status, 1);
    EXPECT_TRUE(contains(too_small.err, "1.0 KiB of --mem-limit")) << too_small.err;
    expect_failure(run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--mem-limit", "1K"}), 1, "--mem-limit");
}

TEST_F(Flags, cut_the_picture_without_changing_what_is_left) {
    const Picture whole = render({"--spp", "2"}), part = render({"--spp", "2", "--crop", "0.25,0.75,0.1,0.6"});
    EXPECT_EQ(part.x0, 6);  // ceil(0.25 * 24)
    EXPECT_EQ(part.y0, 2);  // ceil(0.1 * 18)
    EXPECT_EQ(part.width, 12);
    EXPECT_EQ(part.height, 9);
    EXPECT_EQ(part.header.displayWindow(), whole.header.displayWindow());
    for (int y = part.y0; y < part.y0 + part.height; ++y)
        for (int x = part.x0; x < part.x0 + part.width; ++x)
            for (int channel = 0; channel < 4; ++channel)
                ASSERT_EQ(part.at(x, y)[channel], whole.at(x, y)[channel]) << x << ", " << y;
}

TEST_F(Flags, of_a_crop_between_two_pixels_are_refused) {
    expect_failure(run_raymill({"render", scene_, "--crop", "0.01,0.02,0,1", "-o", folder_.file("a.exr")}), 2,
                   "--crop");
    EXPECT_EQ(folder_.entries(), 1);  // the scene
}

TEST_F(Flags, of_the_device_do_not_change_the_picture) {
    const Picture plain = render({});
    EXPECT_TRUE(same_pixels(plain, render({"--queue-capacity", "7", "--work-group", "8", "--threads", "1"})));
    EXPECT_TRUE(same_pixels(plain, render({"--mem-limit", "1M", "--kernel-dir", RAYMILL_KERNELS})));
    EXPECT_TRUE(same_pixels(plain, render({"--bvh", "fast"})));
    EXPECT_TRUE(same_pixels(plain, render({"--queue-capacity", "64", "--pipelines", "3"})));
    EXPECT_TRUE(same_pixels(plain, render({"--bvh", "high"})));
    EXPECT_FALSE(same_pixels(plain, render({"--depth", "0"})));
}

TEST_F(Flags, of_aovs_add_layers_and_leave_the_picture_alone) {
    const Picture plain = render({}), layered = render({"--aov", "diffuse,N,Z"});
    EXPECT_TRUE(same_pixels(plain, layered));
    for (const char* channel : {"diffuse.R", "N.X", "N.Z", "R", "A"})
        EXPECT_TRUE(layered.header.channels().findChannel(channel)) << channel;
    EXPECT_FALSE(plain.header.channels().findChannel("diffuse.R"));
    EXPECT_FALSE(layered.header.channels().findChannel("specular.R"));
    expect_failure(run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--aov", "shine"}), 2, "shine");
}

TEST_F(Flags, of_half_floats_round_the_picture_a_little) {
    const Picture full = render({}), half = render({"--half"});
    EXPECT_FALSE(same_pixels(full, half));
    for (std::size_t i = 0; i < full.rgba.size(); ++i)
        ASSERT_NEAR(half.rgba[i], full.rgba[i], full.rgba[i] / 2048 + 1e-7);  // 11 significant bits
}

TEST_F(Flags, of_an_unknown_device_are_status_1) {
    expect_failure(run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--device", "abacus"}), 1, "abacus");
    expect_failure(run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--threads", "65536"}), 1, "--threads");
    expect_failure(run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--work-group", "1048576"}), 1,
                   "--work-group");
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(Flags, of_statistics_print_a_row_for_every_kernel_on_standard_error) {
    const Outcome outcome = run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--stats"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    for (const char* part : {"generate", "intersect", "shade", "shadow", "secondary", "wall clock", "film hash"})
        EXPECT_TRUE(contains(outcome.err, part)) << outcome.err << "\nwithout " << part;
}

TEST_F(Flags, of_statistics_files_write_both_beside_the_same_picture) {
    const std::string stats = folder_.file("stats.json"), trace = folder_.file("trace.json");
    const Picture plain = render({}), profiled = render({"--stats-json", stats, "--trace", trace});
    EXPECT_TRUE(same_pixels(plain, profiled));
    const auto json = nlohmann::json::parse(read_bytes(stats));
    EXPECT_EQ(json.at("run").at("width"), 24);
    EXPECT_EQ(json.at("depths").at(0).at("popped"), 432);
    EXPECT_FALSE(json.at("launches").at("rows").empty());
    std::vector<std::string> spans;
    for (const auto& span : json.at("times").at("spans")) spans.push_back(span.at("name"));
    const std::vector<std::string> expected = {"load scene",    "open device",     "build hierarchy", "build kernels",
                                               "upload scene",  "allocate queues", "compile kernels", "render",
                                               "write picture", "hash film"};
    EXPECT_EQ(spans, expected);
    EXPECT_FALSE(nlohmann::json::parse(read_bytes(trace)).at("traceEvents").empty());
}

TEST_F(Flags, of_statistics_files_that_cannot_be_written_are_refused_before_rendering) {
    const std::string picture = folder_.file("a.exr");
    expect_failure(run_raymill({"render", scene_, "-o", picture, "--trace", folder_.file("no/where.json")}), 1,
                   "where.json");
    expect_failure(run_raymill({"render", scene_, "-o", picture, "--stats-json", picture}), 2, "two things at once");
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(Flags, of_outputs_do_not_replace_the_scene) {
    const std::string scene = read_bytes(scene_), link = folder_.file("link.json");
    std::filesystem::create_symlink(scene_, link);
    for (const std::string& output : {scene_, folder_.file("./scene.toml"), link}) {
        SCOPED_TRACE(output);
        for (const char* flag : {"--stats-json", "--trace"})
            expect_failure(run_raymill({"render", scene_, "-o", folder_.file("a.exr"), flag, output}), 2,
                           output + " is what this reads");
        expect_failure(run_raymill({"explain", scene_, "--pixel", "1,1", "--obj", output}), 2, "is what this reads");
        EXPECT_EQ(read_bytes(scene_), scene);
    }
    EXPECT_EQ(folder_.entries(), 2);  // the scene and the link
}

TEST_F(Flags, of_silence_leave_nothing_to_read) {
    const Outcome outcome = run_raymill({"render", scene_, "-o", folder_.file("a.exr"), "--quiet"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out + outcome.err, "");
}

}  // namespace
}  // namespace raymill
