// The layers of an EXR file: which there are, what they hold, and that those of light add up to the picture.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "exr_pixels.hpp"
#include "image/temporary_folder.hpp"
#include "program.hpp"

namespace raymill {
namespace {

using Channels = std::map<std::string, Channel>;

// Seen along -z, a pixel a unit: a ball at (2, 2), a mirror at (4, 2) that shows nothing, behind both a wall that
// covers the lower three rows. A plate, seen edge on, stands in the way of the second lamp, whose light travels along
// (-1, 0, -1), so that the wall's pixel (0, 4) is lit by the first alone.
constexpr const char* known_scene = R"(
[render]
size = [5, 5]
depth = 3
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
projection = "orthographic"
height = 5
[[material]]
name = "mat"
ambient = 0.25
diffuse = [0.75, 0.5, 0.25]
emission = [0, 0, 0.125]
[[material]]
name = "mirror"
diffuse = 0
reflection = 0.5
base_color = [1, 0.5, 0.25]
[[light]]
type = "ambient"
color = 0.5
[[light]]
type = "directional"
direction = [0, 0, -1]
[[light]]
type = "directional"
direction = [-1, 0, -1]
[[object]]
shape = "sphere"
material = "mat"
center = [0, 0, 0]
radius = 1.25
[[object]]
shape = "rectangle"
material = "mirror"
center = [2, 0, 1]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
[[object]]
shape = "rectangle"
material = "mat"
center = [0, -1, -2]
edge_u = [5, 0, 0]
edge_v = [0, 3, 0]
[[object]]
shape = "rectangle"
center = [-1, -2, -1]
edge_u = [0, 0, 0.5]
edge_v = [0, 0.5, 0]
)";

class Aov : public testing::Test {
  protected:
    Aov() { write_text(scene_, small_scene("depth = 4\nspp = 3\n")); }

    Channels render(const std::vector<std::string>& flags) {
        std::vector<std::string> arguments = {"render", scene_, "-o", folder_.file("picture.exr")};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        const Outcome outcome = run_raymill(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read_channels(folder_.file("picture.exr"));
    }

    static std::set<std::string> names_of(const Channels& channels) {
        std::set<std::string> names;
        for (const auto& [name, channel] : channels) names.insert(name);
        return names;
    }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.file("scene.toml");
};

/// The value of a pixel of the known scene.
float at(const Channels& channels, const std::string& name, int x, int y) {
    return channels.at(name).values.at(static_cast<std::size_t>(5 * y + x));
}

void expect_rgb(const Channels& channels, const std::string& layer, int x, int y, const std::array<float, 3>& rgb) {
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(at(channels, layer + "." + "RGB"[k], x, y), rgb[k]) << layer << " at " << x << ", " << y;
}

TEST_F(Aov, all_are_layers_by_the_names_that_other_programs_know) {
    std::set<std::string> expected = {"R",   "G",   "B", "A",         "N.X",         "N.Y",     "N.Z",      "P.X",
                                      "P.Y", "P.Z", "Z", "id.object", "id.material", "depth.V", "samples.V"};
    for (const char* layer :
         {"ambient", "diffuse", "specular", "reflection", "refraction", "emission", "shadow", "albedo"})
        for (const char* channel : {".R", ".G", ".B"}) expected.insert(std::string(layer) + channel);
    EXPECT_EQ(names_of(render({"--aov", "all"})), expected);
}

TEST_F(Aov, only_those_of_the_list_are_written_each_once) {
    EXPECT_EQ(names_of(render({"--aov", "Z,samples,Z"})),
              (std::set<std::string>{"R", "G", "B", "A", "Z", "samples.V"}));
    EXPECT_EQ(names_of(render({})), (std::set<std::string>{"R", "G", "B", "A"}));
}

TEST_F(Aov, leave_the_picture_as_it_is) {
    const Channels plain = render({}), layered = render({"--aov", "all"});
    for (const char* name : {"R", "G", "B", "A"}) EXPECT_EQ(plain.at(name).values, layered.at(name).values) << name;
}

TEST_F(Aov, of_light_add_up_to_the_picture) {
    const Channels channels = render({"--aov", "ambient,diffuse,specular,reflection,refraction,emission"});
    const std::size_t pixels = channels.at("R").values.size();
    std::set<std::string> present;
    for (const char channel : {'R', 'G', 'B'})
        for (std::size_t i = 0; i < pixels; ++i) {
            double sum = 0;
            for (const char* layer : {"ambient", "diffuse", "specular", "reflection", "refraction", "emission"}) {
                const float value = channels.at(std::string(layer) + "." + channel).values[i];
                if (value > 0) present.insert(layer);
                sum += value;
            }
            // The integers are equal; each of the six and the picture is rounded once when it becomes a float.
            const double picture = channels.at(std::string(1, channel)).values[i];
            ASSERT_NEAR(sum, picture, 0x1p-24 * (sum + picture)) << channel << " of pixel " << i;
        }
    for (const char* layer : {"diffuse", "specular", "reflection", "refraction"})
        EXPECT_TRUE(present.contains(layer)) << "the scene has no light of this kind: " << layer;
}

TEST_F(Aov, hold_the_known_answer) {
    write_text(scene_, known_scene);
    const Channels channels = render({"--aov", "all"});
    // The ball's nearest point. Both lamps shine on it: n.l is 1 and sqrt(1/2).
    const float both = 1 + std::sqrt(0.5f);
    expect_rgb(channels, "ambient", 2, 2, {0.125f, 0.125f, 0.125f});
    expect_rgb(channels, "emission", 2, 2, {0, 0, 0.125f});
    expect_rgb(channels, "albedo", 2, 2, {0.75f, 0.5f, 0.25f});
    for (std::size_t k = 0; k < 3; ++k)  // the cosine has a few roundings
        EXPECT_NEAR(at(channels, std::string("diffuse.") + "RGB"[k], 2, 2), (0.75f - 0.25f * float(k)) * both, 1e-6f);
    const std::pair<const char*, float> ball[] = {
        {"N.X", 0},   {"N.Y", 0},       {"N.Z", 1},         {"P.X", 0},     {"P.Y", 0},       {"P.Z", 1.25f},
        {"Z", 3.75f}, {"id.object", 1}, {"id.material", 2}, {"depth.V", 0}, {"samples.V", 1}, {"A", 1}};
    for (const auto& [name, value] : ball) EXPECT_EQ(at(channels, name, 2, 2), value) << name;

    // The mirror sends a ray of depth 1; its albedo is what it passes on, and nothing is there to be seen.
    expect_rgb(channels, "albedo", 4, 2, {0.5f, 0.25f, 0.125f});
    expect_rgb(channels, "reflection", 4, 2, {0, 0, 0});
    EXPECT_EQ(at(channels, "depth.V", 4, 2), 1);
    EXPECT_EQ(at(channels, "id.object", 4, 2), 2);
    EXPECT_EQ(at(channels, "id.material", 4, 2), 3);
}

TEST_F(Aov, say_where_nothing_was_hit) {
    write_text(scene_, known_scene);
    const Channels channels = render({"--aov", "all"});
    for (const char* name : {"Z", "P.X", "P.Y", "P.Z"}) EXPECT_EQ(at(channels, name, 0, 0), INFINITY) << name;
    for (const char* name : {"A", "N.X", "N.Y", "N.Z", "albedo.R", "id.object", "id.material", "depth.V"})
        EXPECT_EQ(at(channels, name, 0, 0), 0) << name;
    EXPECT_EQ(at(channels, "samples.V", 0, 0), 1);
}

TEST_F(Aov, shadow_is_the_share_of_the_lamps_that_is_seen) {
    write_text(scene_, known_scene);
    const Channels channels = render({"--aov", "shadow"});
    expect_rgb(channels, "shadow", 2, 2, {1, 1, 1});
    expect_rgb(channels, "shadow", 0, 4, {0.5f, 0.5f, 0.5f});
    expect_rgb(channels, "shadow", 0, 0, {1, 1, 1});  // no shadow ray
}

TEST_F(Aov, of_half_precision_are_the_colours_alone) {
    const Channels whole = render({"--aov", "all"}), half = render({"--aov", "all", "--half"});
    ASSERT_EQ(names_of(whole), names_of(half));
    for (const auto& [name, channel] : half) {
        // Distances, positions and numbers would lose what they say.
        const bool exact = name == "Z" || name[0] == 'P' || name.starts_with("id.") || name.ends_with(".V");
        EXPECT_EQ(channel.type, exact ? Imf::FLOAT : Imf::HALF) << name;
        EXPECT_EQ(whole.at(name).type, Imf::FLOAT) << name;
        for (std::size_t i = 0; i < channel.values.size(); ++i) {
            const float value = whole.at(name).values[i];
            if (exact || std::isinf(value)) {
                ASSERT_EQ(channel.values[i], value) << name;
            } else {
                // Half floats have 11 bits, and steps of 2^-24 near zero.
                ASSERT_NEAR(channel.values[i], value, 0x1p-11f * std::abs(value) + 0x1p-25f) << name;
            }
        }
    }
}

TEST_F(Aov, that_are_not_known_are_refused_with_those_that_are) {
    expect_failure(run_raymill({"render", scene_, "--aov", "diffuse,normal"}), 2, "\"normal\"; known are ambient, ");
    expect_failure(run_raymill({"render", scene_, "--aov", "N,,Z"}), 2, "no layer \"\"");
    EXPECT_EQ(folder_.entries(), 1);
}

TEST_F(Aov, do_not_fit_into_a_png) {
    expect_failure(run_raymill({"render", scene_, "--aov", "N", "-o", folder_.file("a.png")}), 2, ".exr");
    EXPECT_EQ(folder_.entries(), 1);
}

}  // namespace
}  // namespace raymill
