// What is written: pictures, whole or not at all.
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "exr_pixels.hpp"
#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

class Output : public testing::Test {
  protected:
    Output() { write_text(scene_, small_scene()); }

    Outcome render_to(const std::string& file) { return run_raymill({"render", scene_, "-o", folder_.file(file)}); }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.file("scene.toml");
};

TEST_F(Output, of_a_render_is_named_on_standard_error_alone) {
    const Outcome outcome = render_to("picture.exr");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "picture.exr: 24 x 18 pixels, 1 spp")) << outcome.err;
    EXPECT_FALSE(contains(outcome.err, "\r")) << "a progress bar where there is no terminal";
}

TEST_F(Output, goes_to_the_current_folder_under_the_scenes_name_by_default) {
    const TemporaryFolder elsewhere;
    const Outcome outcome = run_raymill({"render", scene_}, {.folder = elsewhere.path().string()});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(read_picture(elsewhere.file("scene.exr")).width, 24);
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(Output, as_png_begins_as_a_png_does) {
    EXPECT_EQ(render_to("picture.PNG").status, 0);
    EXPECT_EQ(read_bytes(folder_.file("picture.PNG")).substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_EQ(folder_.entries(), 2);
}

TEST_F(Output, of_a_brighter_exposure_is_another_png) {
    render_to("plain.png");
    run_raymill({"render", scene_, "-o", folder_.file("bright.png"), "--exposure", "1"});
    EXPECT_TRUE(read_bytes(folder_.file("plain.png")) != read_bytes(folder_.file("bright.png")));
}

TEST_F(Output, of_unknown_kind_is_status_2_before_anything_is_rendered) {
    expect_failure(render_to("picture.jpg"), 2, ".jpg");
    expect_failure(render_to("picture"), 2, ".exr");
    expect_failure(run_raymill({"render", scene_, "--half", "-o", folder_.file("picture.png")}), 2, "--half");
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(Output, that_cannot_be_written_is_status_1) {
    expect_failure(render_to("no/such/folder/picture.exr"), 1, "no/such/folder");
    fs::create_directory(folder_.path() / "folder.exr");
    expect_failure(render_to("folder.exr"), 1, "folder.exr");
    EXPECT_EQ(folder_.entries(), 2);
}

TEST_F(Output, on_a_standard_output_that_is_full_is_status_1) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"devices"}, {"check", scene_}})
        expect_failure(run_raymill(arguments, {.standard_output = "/dev/full"}), 1, "standard output");
}

TEST_F(Output, replaces_an_older_file_and_leaves_nothing_beside_it) {
    write_text(folder_.file("picture.exr"), "older");
    EXPECT_EQ(render_to("picture.exr").status, 0);
    EXPECT_EQ(read_picture(folder_.file("picture.exr")).height, 18);
    EXPECT_EQ(folder_.entries(), 2);
}

TEST_F(Output, is_not_there_and_an_older_one_untouched_after_a_failure) {
    write_text(folder_.file("picture.exr"), "older");
    for (const char* file : {"picture.exr", "new.exr"})
        expect_failure(run_raymill({"render", scene_, "-o", folder_.file(file), "--mem-limit", "2K"}), 1,
                       "--mem-limit");
    EXPECT_TRUE(read_bytes(folder_.file("picture.exr")) == "older");
    EXPECT_EQ(folder_.entries(), 2);
}

TEST_F(Output, in_exr_says_what_made_it) {
    ASSERT_EQ(render_to("picture.exr").status, 0);
    const Imf::Header header = read_picture(folder_.file("picture.exr")).header;
    const auto text = [&](const char* name) { return header.typedAttribute<Imf::StringAttribute>(name).value(); };
    EXPECT_EQ(text("raymill:version"), RAYMILL_VERSION);
    EXPECT_EQ(text("raymill:scene"), scene_);
    EXPECT_EQ(text("raymill:sceneHash").size(), 16u);
    EXPECT_GT(header.typedAttribute<Imf::FloatAttribute>("raymill:renderTime").value(), 0);

    // The eye is the origin of camera space, and what it looks at is the centre of the picture.
    Imath::V3f eye, centre;
    Imf::worldToCamera(header).multVecMatrix(Imath::V3f(0, 1.5f, 4), eye);
    Imf::worldToNDC(header).multVecMatrix(Imath::V3f(0, 0.7f, 0), centre);
    EXPECT_LT(eye.length(), 1e-5f);  // a few roundings of coordinates near 4
    EXPECT_NEAR(centre.x, 0, 1e-5f);
    EXPECT_NEAR(centre.y, 0, 1e-5f);
}

TEST_F(Output, hash_of_the_scene_changes_with_the_scene_alone) {
    const auto hash = [&] {
        EXPECT_EQ(render_to("picture.exr").status, 0);
        const Imf::Header header = read_picture(folder_.file("picture.exr")).header;
        return header.typedAttribute<Imf::StringAttribute>("raymill:sceneHash").value();
    };
    const std::string first = hash();
    EXPECT_EQ(hash(), first);
    write_text(scene_, small_scene() + "\n");
    EXPECT_NE(hash(), first);
}

TEST_F(Output, may_have_spaces_and_umlauts_in_its_path) {
    const fs::path strange = folder_.path() / "zwölf Öfen 'n \"glass\" ☃";
    fs::create_directory(strange);
    write_text((strange / "schöne szene.toml").string(), small_scene());
    const std::string file = (strange / "größtes bild.exr").string();
    const Outcome outcome = run_raymill({"render", (strange / "schöne szene.toml").string(), "-o", file});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, file)) << outcome.err;
    EXPECT_EQ(read_picture(file).width, 24);
}

TEST_F(Output, of_an_interrupted_render_is_a_whole_file_and_status_130) {
    if (!terminals_can_be_opened()) GTEST_SKIP() << "no pseudo-terminal can be opened here: is /dev/pts mounted?";
    const std::string file = folder_.file("picture.exr");
    // Pressed once, when the progress bar is there, that is, while the program renders.
    bool pressed = false;
    const auto press_ctrl_c = [&](int pid, const std::string& terminal) {
        if (pressed || !contains(terminal, "% ")) return;
        pressed = ::kill(pid, SIGINT) == 0;
    };
    // Hours of work, if nobody stopped it.
    const Outcome outcome = run_raymill({"render", scene_, "-o", file, "--size", "2000x2000", "--spp", "4096",
                                         "--depth", "20", "--queue-capacity", "4096"},
                                        {.watch_terminal = press_ctrl_c});
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(contains(outcome.err, "interrupted: ")) << outcome.err;
    const Picture picture = read_picture(file);
    EXPECT_EQ(picture.width, 2000);
    EXPECT_EQ(picture.height, 2000);
    EXPECT_EQ(folder_.entries(), 2);
}

TEST_F(Output, on_a_terminal_has_a_progress_bar_that_is_wiped) {
    if (!terminals_can_be_opened()) GTEST_SKIP() << "no pseudo-terminal can be opened here: is /dev/pts mounted?";
    const Outcome outcome = run_raymill(
        {"render", scene_, "-o", folder_.file("picture.exr"), "--size", "400x300", "--queue-capacity", "64"},
        {.watch_terminal = [](int, const std::string&) {}});
    EXPECT_EQ(outcome.status, 0);
    const std::size_t bar = outcome.err.rfind("% "), wiped = outcome.err.rfind("\r\033[K");
    ASSERT_TRUE(bar != std::string::npos && wiped != std::string::npos) << outcome.err;
    EXPECT_LT(bar, wiped);
    EXPECT_LT(wiped, outcome.err.find("400 x 300 pixels"));
}

}  // namespace
}  // namespace raymill
