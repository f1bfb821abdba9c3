// What the program says of itself.
#include <gtest/gtest.h>

#include "program.hpp"

namespace raymill {
namespace {

void expect_help(const std::vector<std::string>& arguments, const std::vector<std::string>& parts) {
    const Outcome outcome = run_raymill(arguments);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    for (const std::string& part : parts)
        EXPECT_TRUE(contains(outcome.out, part)) << outcome.out << "\nwithout " << part;
}

TEST(help, of_the_program_names_every_command) {
    for (const char* flag : {"--help", "-h"})
        expect_help({flag}, {"render", "profile", "check", "devices", "explain", "verify", "replay", "scene",
                             "compile", "--version", "raymill COMMAND --help"});
}

TEST(help, of_render_names_its_flags_and_statuses) {
    expect_help({"render", "--help"}, {"SCENE",
                                       "--output",
                                       "--size",
                                       "WxH",
                                       "--spp",
                                       "--depth",
                                       "--integrator",
                                       "--crop",
                                       "x0,x1,y0,y1",
                                       "--seed",
                                       "--exposure",
                                       "--half",
                                       "--aov",
                                       "--device",
                                       "--threads",
                                       "--queue-capacity",
                                       "--work-group",
                                       "--mem-limit",
                                       "--kernel-dir",
                                       "--stats",
                                       "--stats-json",
                                       "--trace",
                                       "--quiet",
                                       "--capture",
                                       "DEPTH[:LAUNCH],STAGE,FILE",
                                       "130",
                                       "Examples:"});
}

TEST(help, of_profile_names_its_lists_files_and_statuses) {
    expect_help({"profile", "--help"},
                {"SCENE", "--queue-capacity", "--work-group", "--threads", "LIST", "--repeats", "--output",
                 "--mem-limit", "profile.csv", "profile.json", "trace.json", "report.html", "130", "Examples:"});
}

TEST(help, of_the_other_commands_names_what_they_take) {
    expect_help({"check", "--help"}, {"SCENE", "--mem-limit", "--size", "Example:"});
    expect_help({"devices", "--help"}, {"OpenCL"});
    expect_help({"explain", "--help"}, {"SCENE", "--pixel", "--sample", "--obj", "Exit status:", "Examples:"});
    expect_help({"verify", "--help"}, {"SCENE", "--size", "--capture", "Columns:", "Exit status:", "Examples:"});
    expect_help({"replay", "--help"}, {"FILE", "--scene", "--repeats", "--clock", "--json", "--queue-capacity",
                                       "--work-group", "--threads", "--traversal", "--kernel-dir", "Exit status:"});
    expect_help({"scene", "--help"}, {"MODEL", "Example:"});
}

TEST(version, is_one_line_on_standard_output) {
    const Outcome outcome = run_raymill({"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "raymill " RAYMILL_VERSION "\n");
    EXPECT_EQ(outcome.err, "");
}

TEST(arguments, that_are_missing_or_unknown_are_status_2_and_lead_to_help) {
    expect_failure(run_raymill({}), 2, "raymill --help");
    expect_failure(run_raymill({"paint"}), 2, "no command \"paint\"; see raymill --help");
    expect_failure(run_raymill({"render"}), 2, "SCENE");
    expect_failure(run_raymill({"render", "a.toml", "--fast"}), 2, "--fast");
    expect_failure(run_raymill({"render", "a.toml", "b.toml"}), 2, "b.toml");
    expect_failure(run_raymill({"render", "a.toml", "--spp", "many"}), 2, "--spp");
    expect_failure(run_raymill({"scene"}), 2, "MODEL");
}

}  // namespace
}  // namespace raymill
