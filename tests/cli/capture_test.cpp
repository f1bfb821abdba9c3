// Captured queues from one command to the next: render, replay, verify.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "exr_pixels.hpp"
#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

class Capture : public testing::Test {
  protected:
    Capture() { write_text(scene_, small_scene()); }

    Outcome render(const std::vector<std::string>& captures, const std::vector<std::string>& flags = {}) {
        std::vector<std::string> arguments = {"render", scene_, "-o", picture_};
        for (const std::string& capture : captures) arguments.insert(arguments.end(), {"--capture", capture});
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        return run_raymill(arguments);
    }
    /// A file with the launch of intersect at depth 0.
    std::string captured() {
        const std::string file = folder_.file("queue.wave");
        EXPECT_EQ(render({"0,intersect," + file}).status, 0);
        return file;
    }
    /// A folder with the kernels, in which triangles, spheres and planes are all a little farther away.
    std::string farther_kernels() {
        const fs::path kernels = folder_.path() / "kernels";
        fs::copy(RAYMILL_KERNELS, kernels, fs::copy_options::recursive);
        std::string text = read_bytes((kernels / "intersect.cl").string());
        const std::size_t place = text.find("    uint misses[");  // right after the traversal
        EXPECT_NE(place, std::string::npos);
        text.insert(place, "    for (uint i = begin; i < end; ++i) hits[i].t *= 1.0001f;\n");
        write_text((kernels / "intersect.cl").string(), text);
        return kernels.string();
    }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.file("scene.toml");
    const std::string picture_ = folder_.file("picture.exr");
};

TEST_F(Capture, of_every_stage_is_replayed_and_verified_and_leaves_the_picture_alone) {
    EXPECT_EQ(render({}).status, 0);
    const Picture plain = read_picture(picture_);
    const std::vector<std::string> stages = {"generate", "intersect", "shade", "shadow", "secondary"};
    std::vector<std::string> captures;
    for (const std::string& stage : stages) captures.push_back("0:1," + stage + "," + folder_.file(stage));
    const Outcome outcome = render(captures, {"--queue-capacity", "150"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(contains(outcome.err, "launch 1 of shade at depth 0, of 5, 64 items")) << outcome.err;
    EXPECT_TRUE(same_pixels(plain, read_picture(picture_)));
    for (const std::string& stage : stages) {
        const Outcome replayed = run_raymill({"replay", folder_.file(stage), "--repeats", "2"});
        EXPECT_EQ(replayed.status, 0) << replayed.err;
        EXPECT_EQ(replayed.err, "");
        for (const std::string& part :
             {stage + " at depth 0, launch 1", std::string("the same in every repeat, and as captured"),
              std::string("ns an item"), std::string("24 x 18 pixels")})
            EXPECT_TRUE(contains(replayed.out, part)) << replayed.out << "\nwithout " << part;
        const Outcome verified = run_raymill({"verify", "--capture", folder_.file(stage)});
        EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
        EXPECT_TRUE(contains(verified.out, "all within bounds")) << verified.out;
        EXPECT_EQ(count_lines(verified.out), 5u) << verified.out;  // heading, two of explanation, one stage, verdict
    }
}

TEST_F(Capture, remembers_what_the_command_line_said_of_the_frame) {
    const std::string file = folder_.file("queue.wave"), json_file = folder_.file("replay.json");
    ASSERT_EQ(render({"1,shadow," + file},
                     {"--size", "40x30", "--spp", "3", "--depth", "2", "--seed", "5", "--crop", "0.25,0.75,0,1"})
                  .status,
              0);
    const Outcome outcome = run_raymill({"replay", file, "--repeats", "3", "--json", json_file});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    const auto json = nlohmann::json::parse(read_bytes(json_file));
    EXPECT_EQ(json.at("stage"), "shadow");
    EXPECT_EQ(json.at("depth"), 1);
    EXPECT_EQ(json.at("width"), 40);
    EXPECT_EQ(json.at("height"), 30);
    EXPECT_EQ(json.at("samples_per_pixel"), 3);
    EXPECT_EQ(json.at("seconds").size(), 3u);
    EXPECT_EQ(json.at("output"), json.at("captured_output"));
    EXPECT_EQ(json.at("repeats_with_other_output"), 0);
    EXPECT_GT(json.at("items_in"), 0);
    EXPECT_GE(json.at("items_in"), json.at("items_out"));
}

TEST_F(Capture, is_cut_into_launches_that_write_the_same) {
    const std::string file = captured(), json_file = folder_.file("replay.json");
    const Outcome outcome = run_raymill({"replay", file, "--queue-capacity", "100", "--work-group", "2", "--threads",
                                         "1", "--traversal", "single", "--clock", "processor", "--json", json_file});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(read_bytes(json_file)).at("launches"), 5);  // of 432 rays
}

TEST_F(Capture, replayed_by_kernels_that_find_other_hits_is_status_1) {
    const std::string file = captured(), kernels = farther_kernels();
    const Outcome replayed = run_raymill({"replay", file, "--kernel-dir", kernels, "--repeats", "2"});
    EXPECT_EQ(replayed.status, 1) << replayed.err;
    EXPECT_TRUE(contains(replayed.out, "NOT as captured")) << replayed.out;
    const Outcome verified = run_raymill({"verify", "--capture", file, "--kernel-dir", kernels});
    EXPECT_EQ(verified.status, 1) << verified.err;
    EXPECT_TRUE(contains(verified.out, "out of bounds")) << verified.out;
}

TEST_F(Capture, finds_its_scene_from_any_folder_and_where_it_was_moved_when_told) {
    const std::string file = captured(), moved = folder_.file("moved.toml");
    EXPECT_EQ(run_raymill({"replay", file, "--repeats", "1"}, {.folder = "/"}).status, 0);
    fs::rename(scene_, moved);
    expect_failure(run_raymill({"replay", file}), 2, "say with --scene where the scene is now");
    expect_failure(run_raymill({"verify", "--capture", file}), 2, "say with SCENE where the scene is now");
    EXPECT_EQ(run_raymill({"replay", file, "--scene", moved, "--repeats", "1"}).status, 0);
    EXPECT_EQ(run_raymill({"verify", moved, "--capture", file}).status, 0);
}

TEST_F(Capture, of_a_scene_that_has_changed_is_refused) {
    const std::string file = captured();
    write_text(scene_, small_scene() + "\n");
    for (const auto& arguments : std::vector<std::vector<std::string>>{{"replay", file}, {"verify", "--capture", file}})
        expect_failure(run_raymill(arguments), 2, "capture it again");
}

TEST_F(Capture, that_is_none_or_damaged_is_refused_before_anything_is_written) {
    const std::string file = captured(), json_file = folder_.file("replay.json");
    expect_failure(run_raymill({"replay", scene_, "--json", json_file}), 2, "no captured queue");
    expect_failure(run_raymill({"replay", folder_.file("nothing"), "--json", json_file}), 2, "No such file");
    const std::string bytes = read_bytes(file);
    write_text(file, bytes.substr(0, bytes.size() / 2));
    expect_failure(run_raymill({"replay", file, "--json", json_file}), 2, "cut off");
    expect_failure(run_raymill({"verify", "--capture", file}), 2, "cut off");
    EXPECT_FALSE(fs::exists(json_file));
}

TEST_F(Capture, and_its_scene_are_not_replaced_by_what_is_written_of_them) {
    const std::string file = captured(), bytes = read_bytes(file);
    expect_failure(run_raymill({"replay", file, "--json", file}), 2, file + " is what this reads");
    expect_failure(run_raymill({"replay", file, "--json", scene_}), 2, scene_ + " is what this reads");
    expect_failure(render({"0,shade," + scene_}), 2, scene_ + " is what this reads");
    EXPECT_TRUE(read_bytes(file) == bytes) << "the capture has changed";
    EXPECT_EQ(read_bytes(scene_), small_scene());
}

TEST_F(Capture, that_the_frame_cannot_have_is_refused_and_nothing_is_written) {
    const std::string file = folder_.file("queue.wave");
    expect_failure(render({"0,paint," + file}), 2, "\"paint\" is no stage");
    expect_failure(render({"0,shade"}), 2, "as in 0,intersect,queue.wave");
    expect_failure(render({"6,shade," + file}), 2, "works on depths 0 to 5");
    expect_failure(render({"5,secondary," + file}), 2, "works on depths 0 to 4");
    expect_failure(render({"0,secondary," + file}, {"--depth", "0"}), 2, "never runs");
    expect_failure(render({"0:9,shade," + file}), 2, "no launch 9 of shade at depth 0, the last is 0");
    expect_failure(render({"0,shade," + picture_}), 2, "two things at once");
    expect_failure(render({"0,shade," + folder_.file("no/where")}), 1, "no/where");
    EXPECT_EQ(folder_.entries(), 1);  // the scene
}

TEST_F(Capture, is_verified_with_its_own_settings_only) {
    const std::string file = captured();
    expect_failure(run_raymill({"verify", "--capture", file, "--size", "8x8"}), 2, "those of the captured frame");
    expect_failure(run_raymill({"verify"}), 2, "SCENE is required, or --capture");
}

}  // namespace
}  // namespace raymill
