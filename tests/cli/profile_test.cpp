// raymill profile: what it accepts, measures and writes, also when it is stopped.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class ProfileCommand : public testing::Test {
  protected:
    ProfileCommand() { write_text(scene_, small_scene()); }

    Outcome profile(const std::vector<std::string>& flags, const Surroundings& surroundings = {}) {
        std::vector<std::string> arguments = {"profile", scene_, "-o", output_};
        if (std::ranges::find(flags, "--repeats") == flags.end()) arguments.insert(arguments.end(), {"--repeats", "2"});
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        return run_raymill(arguments, surroundings);
    }
    Json json() const { return Json::parse(read_bytes(output_ + "/profile.json")); }
    std::vector<std::string> states() const {
        const Json sweep = json();
        std::vector<std::string> states;
        for (const Json& setting : sweep.at("settings")) states.push_back(setting.at("state"));
        return states;
    }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.file("scene.toml");
    const std::string output_ = folder_.file("sweep");
};

using States = std::vector<std::string>;

TEST_F(ProfileCommand, renders_every_combination_and_writes_four_files) {
    const Outcome outcome =
        profile({"--spp", "1", "--queue-capacity", "1k,64", "--work-group", "auto,8", "--threads", "1"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::vector<std::string> settings;
    const Json sweep = json();
    for (const Json& s : sweep.at("settings"))
        settings.push_back(s.at("queue_capacity").dump() + "/" + s.at("work_group").dump() + "/" +
                           s.at("threads").dump());
    EXPECT_EQ(settings, (std::vector<std::string>{"64/0/1", "1024/0/1", "64/8/1", "1024/8/1"}));
    EXPECT_EQ(states(), States(4, "measured"));
    EXPECT_EQ(sweep.at("complete"), true);
    EXPECT_TRUE(read_bytes(output_ + "/profile.csv").starts_with("run,queue_capacity,work_group,"));
    EXPECT_FALSE(Json::parse(read_bytes(output_ + "/trace.json")).at("traceEvents").empty());
    EXPECT_TRUE(read_bytes(output_ + "/report.html").starts_with("<!DOCTYPE html>"));
    EXPECT_EQ(std::distance(fs::directory_iterator(output_), {}), 4);
}

TEST_F(ProfileCommand, prints_the_table_and_the_headline_of_the_report) {
    const Outcome outcome = profile({"--spp", "1", "--queue-capacity", "64,1k"});
    EXPECT_EQ(count_lines(outcome.out), 1u + 2 + 1) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, json().at("finding").at("headline").get<std::string>())) << outcome.out;
    EXPECT_FALSE(contains(outcome.err, "\r")) << "a progress bar where there is no terminal";
    EXPECT_TRUE(contains(outcome.err, "report.html")) << outcome.err;
}

TEST_F(ProfileCommand, renders_the_image_of_render_and_the_same_rays_everywhere) {
    ASSERT_EQ(profile({"--spp", "2", "--queue-capacity", "64,1k"}).status, 0);
    ASSERT_EQ(run_raymill({"render", scene_, "--spp", "2", "-o", folder_.file("a.exr"), "--stats-json",
                           folder_.file("stats.json")})
                  .status,
              0);
    const Json sweep = json(), render = Json::parse(read_bytes(folder_.file("stats.json")));
    for (const Json& setting : sweep.at("settings")) {
        for (const Json& frame : setting.at("frames"))
            EXPECT_EQ(frame.at("film_hash"), render.at("run").at("film_hash"));
        EXPECT_EQ(setting.at("profile").at("run").at("film_hash"), render.at("run").at("film_hash"));
        std::uint64_t rays = 0;
        for (const Json& depth : render.at("depths"))
            rays += depth.at("popped").get<std::uint64_t>() + depth.at("shadow_rays").get<std::uint64_t>();
        EXPECT_EQ(setting.at("rays"), rays);
    }
}

TEST_F(ProfileCommand, records_every_launch_of_the_best_setting) {
    ASSERT_EQ(profile({"--spp", "1", "--queue-capacity", "64,1k"}).status, 0);
    const Json sweep = json(), timeline = sweep.at("timeline");
    EXPECT_EQ(timeline.at("setting"), sweep.at("finding").at("best"));
    std::size_t launches = 0, events = 0;
    for (const Json& stage : timeline.at("profile").at("stages")) launches += stage.at("launches").get<std::size_t>();
    EXPECT_EQ(timeline.at("profile").at("launches").at("rows").size(), launches);
    const Json trace = Json::parse(read_bytes(output_ + "/trace.json"));
    for (const Json& event : trace.at("traceEvents")) events += event.at("ph") == "X" && event.at("tid") == 2;
    EXPECT_EQ(events, launches);
}

TEST_F(ProfileCommand, chooses_samples_and_says_so_unless_they_are_given) {
    const Outcome chosen = profile({"--queue-capacity", "64k", "--repeats", "1"});
    EXPECT_EQ(chosen.status, 0);
    const Json scene = json().at("scene");
    EXPECT_EQ(scene.at("samples_chosen"), true);
    EXPECT_EQ(scene.at("scene_samples_per_pixel"), 1);
    EXPECT_GT(scene.at("samples_per_pixel"), 1) << "the scene is tiny";
    EXPECT_TRUE(contains(chosen.err, "frames of " + scene.at("samples_per_pixel").dump() + " spp")) << chosen.err;
    const Outcome given = profile({"--queue-capacity", "64k", "--spp", "3"});
    EXPECT_FALSE(contains(given.err, "spp")) << given.err;
    EXPECT_EQ(json().at("scene").at("samples_per_pixel"), 3);
    EXPECT_EQ(json().at("scene").at("samples_chosen"), false);
}

TEST_F(ProfileCommand, skips_what_does_not_fit_and_says_why) {
    const Outcome outcome = profile({"--spp", "1", "--queue-capacity", "64,1k,1M", "--mem-limit", "8M"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(states(), (States{"measured", "measured", "skipped"}));
    EXPECT_TRUE(contains(json().at("settings").at(2).at("skipped"), "--mem-limit"));
    EXPECT_TRUE(contains(outcome.out, "skipped: the frame needs")) << outcome.out;
    EXPECT_FALSE(contains(read_bytes(output_ + "/profile.csv"), "\n2,1048576"));
}

TEST_F(ProfileCommand, skips_threads_and_work_groups_that_the_device_does_not_have) {
    EXPECT_EQ(profile({"--spp", "1", "--queue-capacity", "64", "--threads", "1,65536", "--work-group", "1,1M"}).status,
              0);
    EXPECT_EQ(states(), (States{"measured", "skipped", "skipped", "skipped"}));
    EXPECT_TRUE(contains(json().at("settings").at(1).at("skipped"), "--work-group"));
    EXPECT_TRUE(contains(json().at("settings").at(2).at("skipped"), "--threads"));
}

TEST_F(ProfileCommand, fails_and_leaves_nothing_where_no_setting_fits) {
    expect_failure(profile({"--spp", "1", "--queue-capacity", "1M", "--mem-limit", "8M"}), 1, "--mem-limit");
    expect_failure(profile({"--spp", "1", "--threads", "65536"}), 1, "--threads");
    expect_failure(profile({"--spp", "1", "--device", "abacus"}), 1, "abacus");
    EXPECT_FALSE(fs::exists(output_));
}

TEST_F(ProfileCommand, refuses_lists_that_make_no_sense_by_name) {
    for (const char* flag : {"--queue-capacity", "--work-group", "--threads"})
        for (const char* list : {"", ",", "1,", "1,,2", "0", "-1", "1.5k", "1kk", "k", "lots", "1;2", "99999999999",
                                 "18446744073709551615k", "512M"}) {
            SCOPED_TRACE(std::string(flag) + " '" + list + "'");
            expect_failure(profile({std::string(flag) + "=" + list}), 2, flag);
        }
    expect_failure(profile({"--queue-capacity", "auto"}), 2, "--queue-capacity");
    expect_failure(profile({"--repeats", "0"}), 2, "--repeats");
    expect_failure(profile({"--mem-limit", "lots"}), 2, "--mem-limit");
    EXPECT_FALSE(fs::exists(output_));
}

TEST_F(ProfileCommand, needs_a_folder_that_can_be_written) {
    write_text(output_, "a file");
    expect_failure(profile({"--spp", "1", "--queue-capacity", "64"}), 1, "sweep");
    expect_failure(run_raymill({"profile", scene_, "-o", folder_.file("no/where")}), 1, "no/where");
    EXPECT_EQ(read_bytes(output_), "a file");
}

TEST_F(ProfileCommand, writes_beside_the_caller_under_the_scenes_name_by_default) {
    const TemporaryFolder elsewhere;
    const Outcome outcome = run_raymill({"profile", scene_, "--spp", "1", "--queue-capacity", "64", "--repeats", "1"},
                                        {.folder = elsewhere.path().string()});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(fs::exists(elsewhere.path() / "scene-profile" / "report.html"));
}

TEST_F(ProfileCommand, fails_where_an_image_depends_on_the_capacity) {
    const fs::path kernels = folder_.path() / "kernels";
    fs::copy(RAYMILL_KERNELS, kernels, fs::copy_options::recursive);
    std::string text = read_bytes((kernels / "generate.cl").string());
    const std::string right = "first_sample + begin";
    ASSERT_TRUE(contains(text, right));
    text.replace(text.find(right), right.size(), "first_sample + (count > 100 ? 0 : begin)");
    write_text((kernels / "generate.cl").string(), text);
    const Outcome outcome = profile({"--spp", "1", "--queue-capacity", "64,1k", "--kernel-dir", kernels.string()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(contains(outcome.out, "NOT the same")) << outcome.out;
    EXPECT_EQ(json().at("finding").at("same_image"), false);
    EXPECT_EQ(json().at("finding").at("other_image"), Json({1}));
}

/// Presses Ctrl-C, once, when the bar shows `text`: the program is then there, or further by however long that took.
auto interrupt_at(const std::string& text) {
    return [text, pressed = false](int pid, const std::string& terminal) mutable {
        if (!pressed && contains(terminal, text)) pressed = ::kill(pid, SIGINT) == 0;
    };
}

TEST_F(ProfileCommand, that_is_interrupted_leaves_a_report_that_says_it_is_partial) {
    if (!terminals_can_be_opened()) GTEST_SKIP() << "no pseudo-terminal can be opened here: is /dev/pts mounted?";
    // Stopped when the first setting is measured and the second is begun; there would be hours of work.
    const Outcome outcome = profile({"--spp", "512", "--queue-capacity", "1000,1k,2k", "--repeats", "1000"},
                                    {.watch_terminal = interrupt_at("1024 rays, work-group auto")});
    ASSERT_EQ(outcome.status, 130) << outcome.err;
    const Json sweep = json(), settings = sweep.at("settings");
    EXPECT_EQ(sweep.at("complete"), false);
    EXPECT_EQ(settings.at(0).at("state"), "partial");
    // On a busy machine others are measured before the program sees the signal: the first frames tell which is shown.
    std::size_t fastest = 0;
    const auto first_frame = [&](std::size_t i) {
        return settings.at(i).at("frames").at(0).at("seconds").get<double>();
    };
    for (std::size_t i = 0; i < settings.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(settings.at(i).at("state"), settings.at(i).contains("frames") ? "partial" : "not_reached");
        if (settings.at(i).contains("frames") && first_frame(i) < first_frame(fastest)) fastest = i;
    }
    EXPECT_FALSE(settings.at(0).at("frames").empty());
    EXPECT_EQ(sweep.at("timeline").at("setting"), fastest);
    EXPECT_EQ(sweep.at("timeline").at("profile").at("run").at("queue_capacity"),
              settings.at(fastest).at("queue_capacity"));
    EXPECT_FALSE(sweep.at("timeline").at("profile").at("launches").at("rows").empty());
    EXPECT_TRUE(sweep.at("finding").at("headline").get<std::string>().starts_with("Interrupted"));
    EXPECT_TRUE(contains(outcome.out, "Interrupted")) << outcome.out;
    EXPECT_TRUE(contains(read_bytes(output_ + "/trace.json"), "queue of depth 0"));
    EXPECT_EQ(std::distance(fs::directory_iterator(output_), {}), 4);
}

TEST_F(ProfileCommand, that_is_interrupted_in_its_first_frame_says_that_nothing_was_measured) {
    if (!terminals_can_be_opened()) GTEST_SKIP() << "no pseudo-terminal can be opened here: is /dev/pts mounted?";
    // The first frame alone would take minutes.
    const Outcome outcome = profile({"--spp", "1000000", "--queue-capacity", "64,1k"},
                                    {.watch_terminal = interrupt_at("64 rays, work-group auto")});
    ASSERT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_EQ(states(), States(2, "not_reached"));
    EXPECT_EQ(json().at("complete"), false);
    EXPECT_TRUE(json().at("timeline").is_null());
    EXPECT_TRUE(contains(outcome.out, "Interrupted, so this is a part of the sweep. Nothing was measured."))
        << outcome.out;
    EXPECT_TRUE(contains(read_bytes(output_ + "/trace.json"), "build hierarchy"));
    EXPECT_EQ(std::distance(fs::directory_iterator(output_), {}), 4);
}

}  // namespace
}  // namespace raymill
