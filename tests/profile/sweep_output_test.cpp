// A sweep as JSON, CSV, table and page.
#include "profile/sweep_output.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sweep_example.hpp"

namespace raymill::profile {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::map<std::string, std::string>;

std::vector<std::string> keys_of(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    return keys;
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream text(line + ",");
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    return cells;
}

std::vector<Row> csv_of(const Sweep& sweep) {
    std::ostringstream text;
    write_csv(text, sweep);
    std::istringstream lines(text.str());
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> columns = cells_of(line);
    std::vector<Row> rows;
    while (std::getline(lines, line)) {
        const std::vector<std::string> cells = cells_of(line);
        EXPECT_EQ(cells.size(), columns.size()) << line;
        Row& row = rows.emplace_back();
        for (std::size_t i = 0; i < std::min(cells.size(), columns.size()); ++i) row[columns[i]] = cells[i];
    }
    return rows;
}

std::string report_of(const Sweep& sweep) {
    std::ostringstream text;
    write_report(text, to_json(sweep));
    return text.str();
}

/// What stands between the data's script tags.
std::string data_of(const std::string& report) {
    const std::string begin = "<script type=\"application/json\" id=\"data\">";
    const std::size_t from = report.find(begin) + begin.size();
    return report.substr(from, report.find("</script>", from) - from);
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t times = 0;
    for (std::size_t place = text.find(part); place != std::string::npos; place = text.find(part, place + 1)) ++times;
    return times;
}

TEST(SweepJson, has_the_documented_keys) {
    using Keys = std::vector<std::string>;
    const Json json = to_json(sweep_example());
    EXPECT_EQ(keys_of(json), (Keys{"format", "version", "complete", "seconds", "repeats", "scene", "device", "finding",
                                   "settings", "timeline"}));
    EXPECT_EQ(keys_of(json["scene"]), (Keys{"file", "width", "height", "depth", "samples_per_pixel", "samples_chosen",
                                            "scene_samples_per_pixel", "primitives"}));
    EXPECT_EQ(keys_of(json["device"]), (Keys{"name", "platform", "driver", "memory", "caches"}));
    EXPECT_EQ(keys_of(json["finding"]), (Keys{"headline", "best", "knee", "knee_tolerance", "below_knee",
                                              "loss_below_knee", "as_good", "same_image", "film_hash", "other_image"}));
    EXPECT_EQ(keys_of(json["settings"][0]),
              (Keys{"queue_capacity", "work_group", "threads", "state", "skipped", "device_bytes", "wave_bytes",
                    "pipelines", "rays", "rays_per_second", "seconds", "frames", "profile"}));
    EXPECT_EQ(keys_of(json["timeline"]), (Keys{"setting", "launches_left_out", "profile"}));
}

TEST(SweepJson, says_of_every_setting_how_far_it_came) {
    Sweep sweep = sweep_example();
    sweep.settings[0].frames.pop_back();
    sweep.settings[4].frames.clear();
    std::vector<std::string> states;
    const Json json = to_json(sweep);
    for (const Json& setting : json["settings"]) states.push_back(setting["state"]);
    EXPECT_EQ(states, (std::vector<std::string>{"partial", "measured", "measured", "skipped", "not_reached"}));
    EXPECT_EQ(json["settings"][3]["skipped"], "the frame needs 3 GiB");
}

TEST(SweepJson, keeps_the_beginning_of_a_long_timeline_and_says_how_much_it_leaves_out) {
    Sweep sweep = sweep_example();
    std::vector<Launch>& launches = sweep.timeline->frame.launches;
    launches.resize(kept_launches + 7, launches.back());
    const Json timeline = to_json(sweep)["timeline"];
    EXPECT_EQ(timeline["launches_left_out"], 7);
    EXPECT_EQ(timeline["profile"]["launches"]["rows"].size(), kept_launches);
}

TEST(SweepCsv, has_a_row_for_every_measured_setting_stage_and_depth) {
    const Sweep sweep = sweep_example();
    const std::vector<Row> rows = csv_of(sweep);
    std::size_t next = 0;
    for (std::size_t run = 0; run < sweep.settings.size(); ++run) {
        if (!sweep.settings[run].profile) continue;
        for (const StageTotal& total : sweep.settings[run].profile->frame.stages) {
            ASSERT_LT(next, rows.size());
            const Row& row = rows[next++];
            EXPECT_EQ(row.at("run"), std::to_string(run));
            EXPECT_EQ(row.at("stage"), stage_name(total.stage));
            EXPECT_EQ(row.at("depth"), total.depth == no_depth ? "" : std::to_string(total.depth));
        }
    }
    EXPECT_EQ(next, rows.size());
    EXPECT_EQ(rows.size(), 4u * 7) << "four settings were measured, each with seven stages and depths";
}

TEST(SweepCsv, has_the_numbers_of_the_json) {
    const Sweep sweep = sweep_example();
    const Json settings = to_json(sweep)["settings"];
    std::size_t compared = 0;
    for (const Row& row : csv_of(sweep)) {
        const Json& setting = settings[std::stoul(row.at("run"))];
        for (const char* key : {"queue_capacity", "threads", "device_bytes", "rays"})
            EXPECT_EQ(Json::parse(row.at(key)), setting[key]) << key;
        for (const char* key : {"median", "shortest", "longest"})
            EXPECT_EQ(Json::parse(row.at(std::string("frame_") + key)), setting["seconds"][key]) << key;
        for (const Json& stage : setting["profile"]["stages"])
            for (const Json& depth : stage["depths"]) {
                if (stage["stage"] != row.at("stage") || std::to_string(depth["depth"].get<int>()) != row.at("depth"))
                    continue;
                for (const auto& [key, value] : depth.items()) EXPECT_EQ(Json::parse(row.at(key)), value) << key;
                ++compared;
            }
    }
    EXPECT_EQ(compared, 4u * 6) << "all stages but resolve, which has no depth";
}

TEST(SweepTable, has_a_line_for_every_setting_and_the_finding) {
    const std::string text = table(sweep_example());
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 5 + 1);
    EXPECT_NE(text.find("skipped: the frame needs 3 GiB"), std::string::npos);
    EXPECT_NE(text.find("  best\n"), std::string::npos);
    EXPECT_NE(text.find("  knee\n"), std::string::npos);
    EXPECT_NE(text.find("Best: 256 rays"), std::string::npos);
}

TEST(Report, holds_exactly_the_json) {
    const Sweep sweep = sweep_example();
    EXPECT_EQ(Json::parse(data_of(report_of(sweep))), to_json(sweep));
}

TEST(Report, is_not_ended_by_a_scene_that_is_named_like_markup) {
    Sweep sweep = sweep_example();
    sweep.scene = "</script><img src=x>\xff.toml";
    const std::string report = report_of(sweep), plain = report_of(sweep_example());
    EXPECT_EQ(count(report, "</script>"), count(plain, "</script>"));
    EXPECT_EQ(Json::parse(data_of(report))["scene"]["file"], "</script><img src=x>\xef\xbf\xbd.toml");
}

TEST(Report, refers_to_nothing_outside_itself) {
    const std::string report = report_of(sweep_example());
    for (const char* reference : {"://", "src=", "href", "url(", "@import", "fetch(", "XMLHttpRequest", "WebSocket",
                                  "import(", "sendBeacon", "<link", "<iframe"})
        EXPECT_EQ(report.find(reference), std::string::npos) << reference;
    EXPECT_NE(report.find("default-src 'none'"), std::string::npos) << "the browser is told to refuse, too";
}

TEST(Report, has_no_number_but_those_of_the_json) {
    std::string page = report_of(sweep_example());
    const std::string data = data_of(page);
    page.erase(page.find(data), data.size());
    // Without style, scripts and tags only what is shown as it stands is left.
    const auto cut = [&](const std::string& from, const std::string& to) {
        for (std::size_t begin; (begin = page.find(from)) != std::string::npos;)
            page.erase(begin, page.find(to, begin) + to.size() - begin);
    };
    cut("<style>", "</style>");
    cut("<script", "</script>");
    cut("<", ">");
    EXPECT_NE(page.find("profile.json"), std::string::npos) << "the text for browsers without scripts";
    EXPECT_EQ(page.find_first_of("0123456789"), std::string::npos) << page;
}

}  // namespace
}  // namespace raymill::profile
