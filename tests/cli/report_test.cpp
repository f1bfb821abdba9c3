// The report in a browser: what its script makes of the numbers.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

using Json = nlohmann::json;

std::string output_of(const std::string& command) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
    std::string text;
    std::array<char, 4096> bytes;
    for (std::size_t n; pipe && (n = std::fread(bytes.data(), 1, bytes.size(), pipe.get())) > 0;)
        text.append(bytes.data(), n);
    return text;
}

/// The page after its script has run, or what the browser said of it.
std::string in_browser(const std::string& page, const std::string& streams) {
    const TemporaryFolder home;
    return output_of("HOME='" + home.path().string() +
                     "' timeout 60 chromium --headless --no-sandbox --disable-gpu --enable-logging=stderr --dump-dom "
                     "'file://" +
                     page + "' " + streams);
}

class ReportInBrowser : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no chromium here";
    }
    /// Sweeps a small scene.
    void sweep(const std::vector<std::string>& flags) {
        write_text(folder_.file("scene.toml"), small_scene());
        std::vector<std::string> arguments = {
            "profile", folder_.file("scene.toml"), "-o", folder_.file("sweep"), "--spp", "1", "--repeats", "2"};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        ASSERT_EQ(run_raymill(arguments).status, 0);
        json_ = Json::parse(read_bytes(folder_.file("sweep/profile.json")));
    }
    std::string page() const { return folder_.file("sweep/report.html"); }

    const TemporaryFolder folder_;
    Json json_;
};

TEST_F(ReportInBrowser, shows_every_figure_with_a_table_behind_it) {
    sweep({"--queue-capacity", "64,256,1k,1M", "--work-group", "auto,8", "--mem-limit", "8M"});
    const std::string dom = in_browser(page(), "2>/dev/null");
    for (const char* id : {"throughput", "stages", "fill", "groups", "memory", "fates", "timeline"}) {
        const std::size_t begin = dom.find("<figure id=\"" + std::string(id) + "\"");
        ASSERT_NE(begin, std::string::npos) << id;
        const std::string figure = dom.substr(begin, dom.find("</figure>", begin) - begin);
        EXPECT_TRUE(contains(figure, "<svg ")) << id;
        EXPECT_TRUE(contains(figure, "<title>")) << id << " has marks that say what they are";
        EXPECT_TRUE(contains(figure, "<details>") && contains(figure, "<td")) << id;
        for (const char* wrong : {"NaN", "undefined", "Infinity", "null"}) EXPECT_FALSE(contains(figure, wrong)) << id;
    }
    EXPECT_TRUE(contains(dom, json_.at("finding").at("headline").get<std::string>() + "</h1>"));
    EXPECT_TRUE(contains(dom, "Same image"));
    EXPECT_TRUE(contains(dom, "Skipped:"));
}

TEST_F(ReportInBrowser, draws_an_interrupted_sweep_and_says_so) {
    sweep({"--queue-capacity", "64,256,1k"});
    // As an interrupt leaves it: one setting never reached, and the timeline of another than the best.
    json_["complete"] = false;
    json_["timeline"]["setting"] = 0;
    Json unreached = json_["settings"][2];
    for (const char* key : {"rays", "rays_per_second", "seconds", "frames", "profile"}) unreached.erase(key);
    unreached["state"] = "not_reached";
    json_["settings"][2] = unreached;
    json_["finding"]["best"] = json_["finding"]["knee"] = 1;
    json_["finding"]["below_knee"] = nullptr;
    json_["finding"]["as_good"] = Json::array();
    std::string text = read_bytes(page());
    const std::string begin = "id=\"data\">";
    const std::size_t from = text.find(begin) + begin.size();
    text.replace(from, text.find("</script>", from) - from, json_.dump());
    write_text(page(), text);
    EXPECT_EQ(in_browser(page(), "2>&1 >/dev/null | grep CONSOLE"), "");
    const std::string dom = in_browser(page(), "2>/dev/null");
    EXPECT_TRUE(contains(dom, "This report is partial.") && contains(dom, "2 of its 3 settings have all 2 frames"))
        << dom;
    EXPECT_TRUE(contains(dom, "<figure id=\"throughput\"") && contains(dom, "<figure id=\"stages\""));
    EXPECT_TRUE(contains(dom, "One frame with 64 rays"));
}

TEST_F(ReportInBrowser, has_no_error) {
    sweep({"--queue-capacity", "64,1k"});
    EXPECT_EQ(in_browser(page(), "2>&1 >/dev/null | grep CONSOLE"), "");
}

TEST_F(ReportInBrowser, follows_the_numbers_of_its_data) {
    sweep({"--queue-capacity", "64,1k"});
    std::string text = read_bytes(page());
    const std::string key = "\"primitives\":";
    const std::size_t place = text.find(key);
    ASSERT_NE(place, std::string::npos);
    text.replace(place + key.size(), text.find_first_of(",}", place) - place - key.size(), "98765");
    write_text(page(), text);
    EXPECT_TRUE(contains(in_browser(page(), "2>/dev/null"), "98\u202f765")) << "digits in groups of three";
}

}  // namespace
}  // namespace raymill
