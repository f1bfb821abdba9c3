// The table, the JSON and the trace of a profile.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "profile/json.hpp"
#include "profile/table.hpp"
#include "profile/trace.hpp"
#include "run_example.hpp"

namespace raymill::profile {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys_of(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    return keys;
}

using Keys = std::vector<std::string>;

TEST(Json, has_the_documented_keys) {
    const Json json = to_json(run_example());
    EXPECT_EQ(keys_of(json),
              (Keys{"format", "run", "times", "compiled_kernels", "stages", "depths", "waves", "launches"}));
    EXPECT_EQ(keys_of(json["times"]), (Keys{"wall", "not_measured", "spans", "frame"}));
    EXPECT_EQ(keys_of(json["times"]["frame"]), (Keys{"seconds", "kernels", "first_launches", "launching", "host"}));
    EXPECT_EQ(keys_of(json["stages"][0]), (Keys{"stage", "launches", "items_in", "items_out", "capacity", "high_water",
                                                "work_items", "groups", "places", "fullness", "seconds", "shortest",
                                                "longest", "bytes_read", "bytes_written", "atomics", "depths"}));
    EXPECT_EQ(keys_of(json["depths"][0]), (Keys{"depth", "capacity", "high_water", "pushed", "popped", "waves", "fates",
                                                "shadow_rays", "shadow_blocked"}));
    EXPECT_EQ(keys_of(json["depths"][0]["fates"]),
              (Keys{"missed", "absorbed", "depth_limit", "weightless", "one_child", "two_children"}));
}

TEST(Json, has_a_row_for_every_wave_and_launch) {
    const RunProfile run = run_example();
    const Json json = Json::parse(to_json(run).dump());
    ASSERT_EQ(json["waves"]["rows"].size(), run.frame.waves.size());
    ASSERT_EQ(json["launches"]["rows"].size(), run.frame.launches.size());
    for (const Json& row : json["launches"]["rows"]) EXPECT_EQ(row.size(), json["launches"]["columns"].size());
    for (const Json& row : json["waves"]["rows"]) EXPECT_EQ(row.size(), json["waves"]["columns"].size());
    EXPECT_EQ(json["launches"]["rows"][1][0], "intersect");
    EXPECT_EQ(json["launches"]["rows"][1][4], 70);
    EXPECT_TRUE(json["launches"]["rows"].back()[1].is_null()) << "resolve belongs to no depth";
}

TEST(Json, leaves_out_launches_that_were_not_kept) {
    RunProfile run = run_example();
    run.frame.detail = Detail::totals;
    EXPECT_FALSE(to_json(run).contains("launches"));
    EXPECT_FALSE(to_json(run).contains("waves"));
}

TEST(Json, survives_a_file_name_that_is_no_text) {
    RunProfile run = run_example();
    run.scene = "\xff.toml";
    const std::string text = to_json(run).dump(1, ' ', false, Json::error_handler_t::replace);
    EXPECT_TRUE(Json::accept(text));
}

Json trace_of(const RunProfile& run) {
    std::ostringstream text;
    write_trace(text, run);
    return Json::parse(text.str())["traceEvents"];
}

TEST(Trace, has_a_complete_event_for_every_launch_and_span) {
    const RunProfile run = run_example();
    std::vector<Json> host, device;
    for (const Json& event : trace_of(run))
        if (event["ph"] == "X") (event["tid"] == 1 ? host : device).push_back(event);
    ASSERT_EQ(host.size(), run.spans.size());
    ASSERT_EQ(device.size(), run.frame.launches.size());
    EXPECT_EQ(host[1]["name"], "render");
    EXPECT_EQ(host[1]["ts"], 900.0);  // microseconds since the run began
    EXPECT_EQ(host[1]["dur"], 1000.0);
    EXPECT_EQ(device[1]["name"], "intersect");
    EXPECT_EQ(device[1]["ts"], 1012.0);
    EXPECT_EQ(device[1]["dur"], 7.0);
    EXPECT_EQ(device[1]["args"]["items out"], 70);
    EXPECT_EQ(device[1]["args"]["atomics"], 150);
}

TEST(Trace, names_its_process_and_tracks_and_leaves_the_unit_of_time_alone) {
    std::ostringstream text;
    write_trace(text, run_example());
    const Json trace = Json::parse(text.str());
    EXPECT_EQ(keys_of(trace), Keys{"traceEvents"}) << "Perfetto may take displayTimeUnit for the unit of the times";
    std::vector<std::string> names;
    for (const Json& event : trace["traceEvents"])
        if (event["ph"] == "M") names.push_back(event["args"]["name"]);
    EXPECT_EQ(names, (std::vector<std::string>{"raymill example.toml", "host", "an abacus"}));
}

TEST(Trace, follows_the_fill_of_every_queue_back_to_zero) {
    std::map<std::string, std::vector<int>> fills;
    for (const Json& event : trace_of(run_example()))
        if (event["ph"] == "C") fills[event["name"]].push_back(event["args"]["rays"]);
    const std::map<std::string, std::vector<int>> expected = {{"queue of depth 0", {100, 0}},
                                                              {"queue of depth 1", {60, 0}}};
    EXPECT_EQ(fills, expected);
}

TEST(Table, has_a_row_for_every_span_stage_and_depth_and_fits_a_terminal) {
    const RunProfile run = run_example();
    std::istringstream lines(table(run));
    std::set<std::string> first_words;
    for (std::string line; std::getline(lines, line);) {
        EXPECT_LE(line.size(), 120u) << line;
        std::istringstream words(line);
        std::string word;
        words >> word;
        first_words.insert(word);
    }
    for (const char* row : {"load", "render", "not", "wall", "generate", "intersect", "shade", "shadow", "secondary",
                            "resolve", "0", "1", "all"})
        EXPECT_TRUE(first_words.contains(row)) << row;
    EXPECT_FALSE(first_words.contains("features")) << "a stage that did not run";
}

TEST(Table, has_one_line_for_all_depths_that_no_ray_reached) {
    RunProfile run = run_example();
    const std::string all = table(run);
    for (const int depth : {2, 3, 4}) {
        run.frame.depths.emplace_back().depth = depth;
        run.frame.depths.back().capacity = 1000;
    }
    const std::string text = table(run), line = "  2 and deeper: no rays\n";
    ASSERT_NE(text.find(line), std::string::npos) << text;
    EXPECT_EQ(all.find("and deeper"), std::string::npos);
    EXPECT_EQ(std::ranges::count(text, '\n'), std::ranges::count(all, '\n') + 1);
    EXPECT_NE(text.find(line + "  all"), std::string::npos) << text;
}

}  // namespace
}  // namespace raymill::profile
