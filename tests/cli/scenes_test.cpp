// The scenes that come with the project, and the page that walks through those of the lecture.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "program.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

const fs::path root = RAYMILL_ROOT;

std::vector<fs::path> scenes_in(const fs::path& folder) {
    std::vector<fs::path> scenes;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".toml") scenes.push_back(entry.path());
    std::sort(scenes.begin(), scenes.end());
    return scenes;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

void expect_loads_without_a_word(const fs::path& scene) {
    SCOPED_TRACE(scene.string());
    const Outcome outcome = run_raymill({"check", scene.string()});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
}

TEST(Scenes, those_of_the_lecture_load_without_error_or_warning) {
    const auto scenes = scenes_in(root / "scenes/lecture");
    EXPECT_GE(scenes.size(), 19u);  // a topic each
    for (const auto& scene : scenes) expect_loads_without_a_word(scene);
}

TEST(Scenes, those_of_the_gallery_load_without_error_or_warning) {
    const auto scenes = scenes_in(root / "scenes");
    EXPECT_GE(scenes.size(), 5u);
    for (const auto& scene : scenes) expect_loads_without_a_word(scene);
}

TEST(Scenes, the_page_of_the_lecture_shows_each_of_its_scenes) {
    const std::string page = text_of(root / "docs/lecture.md");
    for (const auto& scene : scenes_in(root / "scenes/lecture"))
        EXPECT_TRUE(contains(page, "images/lecture/" + scene.stem().string()));
}

TEST(Scenes, what_the_page_of_the_lecture_links_to_is_there) {
    const std::string page = text_of(root / "docs/lecture.md");
    const std::regex link(R"(\]\(([^)#]+)\))");
    int links = 0;
    for (std::sregex_iterator match(page.begin(), page.end(), link), end; match != end; ++match, ++links)
        EXPECT_TRUE(fs::exists(root / "docs" / (*match)[1].str())) << (*match)[1].str();
    EXPECT_GE(links, 28);  // a picture each
}

}  // namespace
}  // namespace raymill
