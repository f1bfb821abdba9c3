// Bad input: status 2, a sentence that says where, and no output file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

class BadInput : public testing::Test {
  protected:
    /// The scene must be refused by render and by check, with this in the message, and must not touch any output.
    void expect_refused(const std::string& scene, const std::string& part_of_message) {
        SCOPED_TRACE(scene);
        write_text(folder_.file("precious.exr"), "not to be lost");
        const auto entries = folder_.entries();
        expect_failure(run_raymill({"check", folder_.file(scene)}), 2, part_of_message);
        expect_failure(run_raymill({"render", folder_.file(scene), "-o", folder_.file("new.exr")}), 2, part_of_message);
        expect_failure(run_raymill({"render", folder_.file(scene), "-o", folder_.file("precious.exr")}), 2,
                       part_of_message);
        EXPECT_EQ(folder_.entries(), entries);
        EXPECT_TRUE(read_bytes(folder_.file("precious.exr")) == "not to be lost");
    }
    void expect_text_refused(const std::string& text, const std::string& part_of_message,
                             const std::string& name = "scene.toml") {
        write_text(folder_.file(name), text);
        expect_refused(name, part_of_message);
    }

    const TemporaryFolder folder_;
};

TEST_F(BadInput, a_missing_file) {
    expect_refused("missing.toml", "missing.toml: cannot read");
}
TEST_F(BadInput, a_missing_model) {
    expect_refused("missing.obj", "missing.obj");
}

TEST_F(BadInput, a_folder) {
    std::filesystem::create_directory(folder_.path() / "folder.toml");
    expect_refused("folder.toml", "it is a folder");
}

TEST_F(BadInput, an_unknown_extension) {
    expect_text_refused("[render]", "\".txt\"", "scene.txt");
}
TEST_F(BadInput, wrong_toml) {
    expect_text_refused("[render]\nsize = [1, ", "scene.toml:2:");
}

TEST_F(BadInput, binary_junk) {
    std::string junk;
    for (int i = 0; i < 5000; ++i) junk += static_cast<char>((i * 2654435761u) >> 24);
    expect_text_refused(junk, "scene.toml:1:");
}

TEST_F(BadInput, a_value_of_the_wrong_type_at_its_line_and_column) {
    expect_text_refused(small_scene("spp = \"many\""), "scene.toml:3:7: render: spp");
}

TEST_F(BadInput, an_unknown_key_at_its_line) {
    expect_text_refused(small_scene("sise = 3"), "scene.toml:3:");
}

TEST_F(BadInput, a_mesh_file_that_is_missing) {
    expect_text_refused(small_scene() + "[[object]]\nshape = \"mesh\"\nfile = \"gone.obj\"\n", "gone.obj");
}

TEST_F(BadInput, of_25_faults_shows_20_and_counts_the_rest) {
    std::string text = small_scene();
    for (int i = 0; i < 25; ++i) text += fmt::format("[[light]]\ntype = \"point\"\nposition = [{}, 0]\n", i);
    write_text(folder_.file("scene.toml"), text);
    const Outcome outcome = run_raymill({"check", folder_.file("scene.toml")});
    expect_failure(outcome, 2, "position");
    EXPECT_EQ(count_lines(outcome.err), 21u) << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with("\nand 5 more errors\n")) << outcome.err;
}

TEST_F(BadInput, all_faults_are_shown_in_the_order_of_the_file) {
    write_text(folder_.file("scene.toml"), small_scene("spp = 0\ndepth = -1") + "[[object]]\nshape = \"cube\"\n");
    const std::string err = run_raymill({"check", folder_.file("scene.toml")}).err;
    const std::size_t spp = err.find("spp"), depth = err.find("depth"), cube = err.find("cube");
    EXPECT_TRUE(spp < depth && depth < cube && cube < err.size()) << err;
}

TEST(an_empty_file, renders_the_background_with_a_warning_that_names_it) {
    for (const char* name : {"empty.toml", "empty.obj"}) {
        const TemporaryFolder folder;
        write_text(folder.file(name), "");
        const Outcome outcome =
            run_raymill({"render", folder.file(name), "--size", "8x6", "-o", folder.file("empty.exr")});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "warning: " + folder.file(name) + ": there are no ")) << outcome.err;
        EXPECT_TRUE(std::filesystem::exists(folder.file("empty.exr")));
    }
}

}  // namespace
}  // namespace raymill
