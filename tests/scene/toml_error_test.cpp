// Each rule of the scene file: what breaks it is an error at the line and column of the key or value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_files.hpp"

namespace raymill {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

struct Rule {
    const char* name;
    const char* text;
    const char* fault;  // how the only fault begins
};

void PrintTo(const Rule& rule, std::ostream* out) {
    *out << rule.text;
}

class BrokenRule : public testing::TestWithParam<Rule> {};

TEST_P(BrokenRule, is_an_error_with_its_place) {
    const SceneFiles files;
    EXPECT_THAT(files.faults(GetParam().text), ElementsAre(StartsWith(GetParam().fault)));
}

#define LIGHT "[[light]]\n"
#define OBJECT "[[object]]\n"
#define MATERIAL "[[material]]\nname = \"m\"\n"

const Rule rules[] = {
    {"syntax", "[render]\nspp = = 1\n", "2:7: "},
    {"unknown_table", "[rendr]\n", "1:2: scene: unknown key \"rendr\"; did you mean \"render\"?"},
    {"unknown_key", "[camera]\nfovv = 30\n", "2:1: camera: unknown key \"fovv\"; did you mean \"fov\"?"},
    {"key_far_from_all_known", "[camera]\nzzz = 30\n", "2:1: camera: unknown key \"zzz\"; known here: projection, eye"},
    {"wrong_type", "[render]\nspp = \"many\"\n", "2:7: render: spp must be a whole number, not text"},
    {"fraction_for_whole", "[render]\nspp = 1.5\n", "2:7: render: spp must be a whole number, not a number"},
    {"table_for_array", "[light]\ntype = \"point\"\n", "1:1: scene: light must be written with double brackets"},
    {"array_for_table", "[[camera]]\nfov = 30\n", "1:1: scene: camera must be a table, not a list"},
    {"spp_zero", "[render]\nspp = 0\n", "2:7: render: spp must lie between 1 and"},
    {"negative_depth", "[render]\n  depth = -1\n", "2:11: render: depth must lie between 0 and"},
    {"size_zero", "[render]\nsize = [640, 0]\n", "2:14: render: size must lie between 1 and"},
    {"size_fraction", "[render]\nsize = [640, 1.5]\n", "2:8: render: size must be whole numbers"},
    {"size_of_three", "[render]\nsize = [1, 2, 3]\n", "2:8: render: size must be a list of 2 numbers, not 3 of them"},
    {"path", "[render]\nintegrator = \"path\"\n", "2:14: render: integrator \"path\" is not in this version"},
    {"word", "[render]\nshadows = \"filterd\"\n", "2:11: render: shadows must be one of filtered, opaque, none"},
    {"negative_background", "[render]\nbackground = [0, -1, 0]\n", "2:18: render: background must be at least 0"},
    {"empty_crop", "[render]\ncrop = [0.5, 0.5, 0, 1]\n", "2:8: render: crop holds no pixel"},
    {"infinity", "[camera]\nfov = inf\n", "2:7: camera: fov must be a finite number, not inf"},
    {"too_large_for_a_float", "[camera]\neye = [1e39, 0, 0]\n", "2:8: camera: eye must be a number that a 32-bit"},
    {"fov", "[camera]\nfov = 180\n", "2:7: camera: fov must lie between 0 and 180, both excluded, not 180"},
    {"height_of_perspective", "[camera]\nheight = 3\n", "2:1: camera: unknown key \"height\""},
    {"height", "[camera]\nprojection = \"orthographic\"\nheight = 0\n", "3:10: camera: height must be above 0"},
    {"aperture", "[camera]\naperture = -1\n", "2:12: camera: aperture must be at least 0"},
    {"focus", "[camera]\nfocus = 0\n", "2:9: camera: focus must be above 0"},
    {"no_view", "[camera]\neye = [1, 2, 3]\nlook_at = [1, 2, 3]\n", "3:11: camera: look_at must differ"},
    {"no_up", "[camera]\nup = [0, 0, 0]\n", "2:6: camera: up must not be zero"},
    {"up_along_view", "[camera]\nup = [0, 0, -2]\n", "2:6: camera: up must not be parallel"},
    {"nameless_material", "[[material]]\ndiffuse = 1\n", "1:1: material 1: the key \"name\" is missing"},
    {"same_name", MATERIAL MATERIAL, "4:8: material 2 (\"m\"): name \"m\" is already taken"},
    {"blend", MATERIAL "reflection = 0.5\ntransmission = 0.6\n",
     "4:16: material 1 (\"m\"): transmission and reflection"},
    {"reflection", MATERIAL "reflection = 1.5\n", "3:14: material 1 (\"m\"): reflection must lie between 0 and 1"},
    {"ior", MATERIAL "ior = 0\n", "3:7: material 1 (\"m\"): ior must be above 0, not 0"},
    {"ior_that_vanishes_as_float", MATERIAL "ior = 1e-60\n", "3:7: material 1 (\"m\"): ior must be above 0"},
    {"colour", MATERIAL "diffuse = \"red\"\n", "3:11: material 1 (\"m\"): diffuse must be a colour"},
    {"checker_scale", MATERIAL "diffuse_checker = { scale = 0 }\n",
     "3:29: material 1 (\"m\"): diffuse_checker: scale must be above 0"},
    {"checker_key", MATERIAL "diffuse_checker = { c = 0 }\n", "3:21: material 1 (\"m\"): diffuse_checker: unknown key"},
    {"missing_picture", MATERIAL "diffuse_map = \"no.png\"\n", "3:15: cannot read the texture"},
    {"light_type", LIGHT "type = \"pont\"\nposition = [0, 0, 0]\n", "2:8: light 1: type must be one of"},
    {"typeless_light", LIGHT "position = [0, 0, 0]\n", "1:1: light 1: the key \"type\" is missing"},
    {"homeless_light", LIGHT "type = \"point\"\n", "1:1: light 1: the key \"position\" is missing"},
    {"attenuation_zero", LIGHT "type = \"point\"\nposition = [0, 0, 0]\nattenuation = [0, 0, 0]\n",
     "4:15: light 1: attenuation must not be all zero"},
    {"attenuation_negative", LIGHT "type = \"point\"\nposition = [0, 0, 0]\nattenuation = [1, -1, 0]\n",
     "4:15: light 1: attenuation must not be negative"},
    {"attenuation_of_the_sun", LIGHT "type = \"directional\"\ndirection = [0, -1, 0]\nattenuation = [1, 0, 0]\n",
     "4:1: light 1: unknown key \"attenuation\""},
    {"direction_zero", LIGHT "type = \"directional\"\ndirection = [0, 0, 0]\n",
     "3:13: light 1: direction must not be zero"},
    {"inner_beyond_outer",
     LIGHT "type = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, 1, 0]\ninner_angle = 40\nouter_angle = 30\n",
     "5:15: light 1: inner_angle must not exceed outer_angle (30)"},
    {"parallel_edges", LIGHT "type = \"rectangle\"\ncenter = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [2, 0, 0]\n",
     "4:10: light 1: edge_u and edge_v must span an area"},
    {"no_samples", LIGHT "type = \"point\"\nposition = [0, 0, 0]\nsamples = 0\n", "4:11: light 1: samples must lie"},
    {"visible_point", LIGHT "type = \"point\"\nposition = [0, 0, 0]\nvisible = true\n", "4:1: light 1: unknown key"},
    {"color_of_area_light", LIGHT "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\ncolor = 2\n",
     "5:1: light 1: unknown key \"color\""},
    {"second_light_by_name",
     LIGHT "type = \"ambient\"\n" LIGHT "type = \"point\"\nname = \"lamp\"\nposition = [0, 0]\n",
     "6:12: light 2 (\"lamp\"): position must be a list of 3 numbers, not 2 of them"},
    {"shape", OBJECT "shape = \"spere\"\nradius = 1\n", "2:9: object 1: shape must be one of"},
    {"radiusless_sphere", OBJECT "shape = \"sphere\"\ncenter = [0, 0, 0]\n",
     "1:1: object 1: the key \"radius\" is missing"},
    {"radius", OBJECT "shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = -1\n",
     "4:10: object 1: radius must be above 0"},
    {"unknown_material", MATERIAL OBJECT "shape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = \"n\"\n",
     "7:12: object 1: material \"n\" is not the name of a material; did you mean \"m\"?"},
    {"scale", OBJECT "shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nscale = [1, 0, 1]\n",
     "5:9: object 1: scale must not be zero"},
    {"matrix_row",
     OBJECT "shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]\n",
     "5:10: object 1: matrix must end with the row 0, 0, 0, 1"},
    {"matrix_singular",
     OBJECT "shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1]\n",
     "5:10: object 1: matrix must be invertible"},
    {"box_inside_out", OBJECT "shape = \"box\"\nmin = [0, 0, 0]\nmax = [1, 0, 1]\n",
     "4:7: object 1: max must be above min"},
    {"flat_cylinder", OBJECT "shape = \"cylinder\"\nbase = [0, 0, 0]\ntop = [0, 0, 0]\nradius = 1\n",
     "4:7: object 1: top must differ from base"},
    {"triangle_of_two", OBJECT "shape = \"triangle\"\nvertices = [[0, 0, 0], [1, 0, 0]]\n",
     "3:12: object 1: vertices must be 3 points, not 2"},
    {"normals_and_vertices", OBJECT "shape = \"triangle\"\nvertices = [[0,0,0],[1,0,0],[0,1,0]]\nnormals = [[0,0,1]]\n",
     "4:11: object 1: normals must have one entry a vertex, 3, not 1"},
    {"index", OBJECT "shape = \"mesh\"\nvertices = [[0,0,0],[1,0,0],[0,1,0]]\nfaces = [[0, 1, 3]]\n",
     "4:17: object 1: an index in faces must be a whole number from 0 to 2"},
    {"face_of_two", OBJECT "shape = \"mesh\"\nvertices = [[0,0,0],[1,0,0],[0,1,0]]\nfaces = [[0, 1]]\n",
     "4:10: object 1: a face in faces must be a list of three or more"},
    {"stl", OBJECT "shape = \"mesh\"\nfile = \"a.stl\"\n",
     "3:8: object 1: file is \"a.stl\", but a mesh is read from .obj, .ply, .gltf or .glb"},
    {"missing_mesh", OBJECT "shape = \"mesh\"\nfile = \"no.obj\"\n", "3:8: cannot read the mesh"},
    {"negative_profile", OBJECT "shape = \"lathe\"\nprofile = [[0, 0], [-1, 1]]\n",
     "3:11: object 1: profile has a negative radius in point 2"},
    {"profile_on_axis", OBJECT "shape = \"lathe\"\nprofile = [[0, 0], [0, 1]]\n",
     "3:11: object 1: profile must leave the axis"},
    {"profile_missing", OBJECT "shape = \"lathe\"\nsegments = 8\n", "1:1: object 1: the key \"profile\" is missing"},
};

INSTANTIATE_TEST_SUITE_P(SceneFile, BrokenRule, testing::ValuesIn(rules),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(SceneFileErrors, are_all_reported_in_the_order_of_the_file) {
    const SceneFiles files;
    EXPECT_THAT(files.faults(OBJECT "shape = \"sphere\"\nradus = 3\ncenter = [0, 0, 0]\n"
                                    "[render]\nspp = 0\n[camera]\nfov = 0\n"),
                ElementsAre(StartsWith("1:1: object 1: the key \"radius\" is missing"),
                            StartsWith("3:1: object 1: unknown key \"radus\"; did you mean \"radius\"?"),
                            StartsWith("6:7: render: spp"), StartsWith("8:7: camera: fov")));
}

TEST(SceneFileErrors, of_a_mesh_stand_at_its_own_lines) {
    const SceneFiles files;
    const std::string mesh = files.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    EXPECT_THAT(
        files.faults("[render]\nspp = 0\n" OBJECT "shape = \"mesh\"\nfile = \"a.obj\"\n"),
        ElementsAre(StartsWith("2:7: render: spp"), mesh + ":4: the face refers to vertex 4, but the file has 3"));
}

TEST(SceneFileErrors, of_a_hundred_faults_twenty_are_shown) {
    const SceneFiles files;
    std::string text;
    for (int i = 0; i < 100; ++i) text += LIGHT "type = \"point\"\n";
    const std::string file = files.write("scene.toml", text);
    try {
        load_scene(file);
        FAIL() << "no error";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.diagnostics().size(), 100u);
        EXPECT_THAT(error.what(), HasSubstr("light 20: "));
        EXPECT_THAT(error.what(), Not(HasSubstr("light 21: ")));
        EXPECT_THAT(error.what(), HasSubstr("and 80 more errors"));
    }
}

TEST(SceneFileErrors, say_why_a_file_cannot_be_read) {
    const SceneFiles files;
    const auto reason = [](const std::string& file) {
        try {
            load_scene(file);
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(reason(files.path("none.toml")), HasSubstr("cannot read the scene file: No such file"));
    std::filesystem::create_directory(files.path("folder.toml"));
    EXPECT_THAT(reason(files.path("folder.toml")), HasSubstr("it is a folder"));
    EXPECT_THAT(reason(files.path("model.stl")), HasSubstr("is what is read, not \".stl\""));
    EXPECT_THAT(reason(files.path("none.obj")), HasSubstr("cannot read the mesh"));
}

TEST(SceneFileErrors, are_none_where_fractions_sum_to_one_on_paper) {
    const SceneFiles files;
    for (const char* blend : {"reflection = 0.1\ntransmission = 0.9\n", "reflection = 0.43\ntransmission = 0.57\n"})
        EXPECT_THAT(files.faults(std::string(MATERIAL) + blend), IsEmpty()) << blend;
}

}  // namespace
}  // namespace raymill
