// OBJ and MTL.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scene_files.hpp"

namespace raymill {
namespace {

using testing::HasSubstr;

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// What the only fault says, without the file's name.
std::string fault_of(const std::string& obj) {
    const SceneFiles files;
    const std::string file = files.write("model.obj", obj);
    try {
        load_scene(file);
    } catch (const SceneError& error) {
        const std::string text = to_string(error.diagnostics().at(0));
        return error.diagnostics().size() == 1 ? text.substr(file.size() + 1) : "several: " + text;
    }
    return "none";
}

bool warns_of(const Scene& scene, const std::string& words) {
    for (const Diagnostic& warning : scene.warnings)
        if (to_string(warning).find(words) != std::string::npos) return true;
    return false;
}

TEST(Obj, reads_relative_indices_back_from_the_newest_vertex) {
    const Scene scene = SceneFiles().obj("v 9 9 9\n" + square + "f -4 -3 -2 -1\nv 5 5 5\n");
    ASSERT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(position(scene, scene.triangles[0], 0), glm::vec3(0, 0, 0));
    EXPECT_EQ(position(scene, scene.triangles[1], 2), glm::vec3(0, 1, 0));
}

TEST(Obj, shares_vertices_with_equal_attributes_only) {
    const Scene scene = SceneFiles().obj(square + "vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/1 4/1\nf 1/2 2/1 3/1\n");
    EXPECT_EQ(scene.vertices.size(), 5u);
    EXPECT_EQ(scene.triangles[0].vertex[0], scene.triangles[1].vertex[0]);
    EXPECT_NE(scene.triangles[0].vertex[0], scene.triangles[2].vertex[0]);
    EXPECT_EQ(scene.vertices[scene.triangles[2].vertex[0]].uv[1], 1);
}

TEST(Obj, reads_normals_and_makes_them_unit) {
    const Scene scene = SceneFiles().obj(square + "vn 0 0 5\nf 1//1 2//1 3//1\n");
    EXPECT_EQ(vertex_normal(scene, scene.triangles[0], 2), glm::vec3(0, 0, 1));
}

TEST(Obj, accepts_continued_lines_comments_and_windows_line_ends) {
    const Scene scene = SceneFiles().obj("v 0 0 0 # corner\r\nv +1 0 \\\r\n 0\r\nv 0 1. 0\rv 0 .5e1 0\nf 1 2 \\\n3\n");
    ASSERT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(position(scene, scene.triangles[0], 1), glm::vec3(1, 0, 0));
}

TEST(Obj, rounds_numbers_to_the_nearest_float) {
    const Scene scene = SceneFiles().obj("v 0.1 16777217.0 1e-45\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(position(scene, scene.triangles[0], 0), glm::vec3(0.1f, 16777216.0f, 1e-45f));
}

TEST(Obj, keeps_coordinates_that_are_not_finite) {
    const Scene scene = SceneFiles().obj("v nan -inf 1.#IND\nv 1.#INF -1.#INF 0\nv 0 1 0\nf 1 2 3\n");
    const glm::vec3 a = position(scene, scene.triangles[0], 0), b = position(scene, scene.triangles[0], 1);
    EXPECT_TRUE(std::isnan(a.x) && std::isinf(a.y) && std::isnan(a.z));
    EXPECT_EQ(b, glm::vec3(INFINITY, -INFINITY, 0));
}

TEST(Obj, faces_may_have_more_than_255_corners) {
    std::string text, face = "f";
    for (int i = 0; i < 300; ++i) {
        text +=
            "v " + std::to_string(std::cos(i * M_PI / 150)) + " " + std::to_string(std::sin(i * M_PI / 150)) + " 0\n";
        face.append(" ").append(std::to_string(i + 1));
    }
    EXPECT_EQ(SceneFiles().obj(text + face + "\n").triangles.size(), 298u);
}

TEST(Obj, faces_that_refer_to_nothing_are_errors_with_their_line) {
    EXPECT_EQ(fault_of(square + "f 1 2 5\n"), "5: the face refers to vertex 5, but the file has 4");
    EXPECT_EQ(fault_of(square + "f 1 2 -5\n"), "5: the face refers to vertex -5, but there are 4 so far");
    EXPECT_EQ(fault_of(square + "f 0 1 2\n"), "5: the index of a vertex is 0, but indices count from 1");
    EXPECT_EQ(fault_of(square + "vt 0 0\nf 1/2 2/1 3/1\n"),
              "6: the face refers to texture coordinate 2, but the file has 1");
    EXPECT_EQ(fault_of(square + "vn 0 0 1\nf 1//1 2//1 3//7\n"), "6: the face refers to normal 7, but the file has 1");
    EXPECT_EQ(fault_of(square + "f 1 2 x\n"), "5: \"x\" is not the index of a vertex");
    EXPECT_EQ(fault_of(square + "f 1 2 99999999999999999999\n"),
              "5: \"99999999999999999999\" is not the index of a vertex");
    EXPECT_EQ(fault_of("v 1 2\n"), "1: three coordinates are needed, not 2");
    EXPECT_EQ(fault_of("v 1 2 three\n"), "1: \"three\" is not a number");
}

TEST(Obj, may_use_vertices_before_they_are_written) {
    EXPECT_EQ(SceneFiles().obj("f 1 2 3\n" + square).triangles.size(), 1u);
}

TEST(Obj, warns_of_what_it_leaves_out) {
    const Scene scene = SceneFiles().obj(square + "p 1\nl 1 2\nf 1 2\nf 1/1 2/1 3/1\n");
    EXPECT_TRUE(warns_of(scene, "2 lines, points"));
    EXPECT_TRUE(warns_of(scene, ":7: 1 faces with fewer than three corners"));
    EXPECT_TRUE(warns_of(scene, "but the file has none"));
    EXPECT_EQ(scene.triangles.size(), 1u);
}

TEST(Obj, makes_an_object_of_each_group_with_faces) {
    const Scene scene =
        SceneFiles().obj(square + "f 1 2 3\no first\ng empty\ng b\nf 1 2 3\nf 1 3 4\no first\nf 2 3 4\n");
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.objects[0].name, "mesh");
    EXPECT_EQ(scene.objects[1].name, "b");
    EXPECT_EQ(scene.objects[2].name, "first");
    EXPECT_EQ(scene.triangles[2].object, 1u);
    EXPECT_EQ(scene.triangles[3].object, 2u);
}

/// Two squares that meet at the y axis at a right angle, in the smoothing groups a and b.
std::string corner(const std::string& a, const std::string& b) {
    return "v -1 0 0\nv 0 0 0\nv 0 1 0\nv -1 1 0\nv 0 0 -1\nv 0 1 -1\ns " + a + "\nf 1 2 3 4\ns " + b + "\nf 2 5 6 3\n";
}

TEST(Obj, smooths_within_a_group_and_not_across) {
    const Scene same = SceneFiles().obj(corner("1", "1")), other = SceneFiles().obj(corner("1", "2"));
    const Scene off = SceneFiles().obj(corner("off", "off"));
    EXPECT_EQ(same.vertices.size(), 6u);
    EXPECT_EQ(other.vertices.size(), 8u);
    EXPECT_EQ(off.vertices.size(), 6u);
    for (const Vertex& v : same.vertices)
        if (v.position[0] == 0 && v.position[2] == 0) {
            EXPECT_NEAR(v.normal[0], std::sqrt(0.5), 1e-6);  // float rounding
            EXPECT_NEAR(v.normal[2], std::sqrt(0.5), 1e-6);
        }
    for (const Triangle& t : other.triangles)
        EXPECT_NEAR(glm::distance(vertex_normal(other, t, 0), face_normal(other, t)), 0, 1e-6);
    for (const Vertex& v : off.vertices) EXPECT_EQ(vec(v.normal), glm::vec3(0));
}

TEST(Obj, prefers_its_own_normals_to_its_groups) {
    const Scene scene = SceneFiles().obj(square + "vn 0 1 0\ns 1\nf 1//1 2//1 3//1\n");
    EXPECT_EQ(vertex_normal(scene, scene.triangles[0], 0), glm::vec3(0, 1, 0));
}

TEST(Obj, without_its_material_file_is_loaded_with_a_warning) {
    const Scene scene = SceneFiles().obj("mtllib none.mtl\n" + square + "usemtl red\nf 1 2 3\n");
    EXPECT_TRUE(warns_of(scene, ":1: cannot read the material file \"none.mtl\""));
    EXPECT_TRUE(warns_of(scene, ":6: there is no material \"red\""));
    EXPECT_EQ(scene.triangles[0].material, 0u);
}

TEST(Obj, finds_material_files_with_blanks_in_their_names) {
    for (const char* line : {"mtllib my file.mtl", "mtllib my\\ file.mtl", "mtllib other.mtl my\\ file.mtl"}) {
        const SceneFiles files;
        files.write("my file.mtl", "newmtl red\nKd 1 0 0\n");
        const Scene scene = files.obj(std::string(line) + "\n" + square + "usemtl red\nf 1 2 3\n");
        EXPECT_EQ(scene.materials.back().name, "red") << line;
    }
}

/// The material that these MTL lines describe.
SceneMaterial mtl(const std::string& lines) {
    const SceneFiles files;
    files.write("a.mtl", "newmtl before\nKd 1 1 1\nillum 2\nnewmtl m # the one\n" + lines + "newmtl after\nillum 7\n");
    const Scene scene = files.obj("mtllib a.mtl\n" + square + "usemtl m\nf 1 2 3\n");
    return scene.materials.at(scene.triangles.at(0).material);
}

TEST(Mtl, reads_the_local_terms) {
    const SceneMaterial m = mtl("Ka .1 .2 .3 # words\nKd .4 .5 .6\nKs .7 .8 .9\nNs 50\nKe 4 5 6\nillum 2\n");
    EXPECT_EQ(m.name, "m");
    EXPECT_EQ(m.ambient, glm::vec3(.1f, .2f, .3f));
    EXPECT_EQ(m.diffuse, glm::vec3(.4f, .5f, .6f));
    EXPECT_EQ(m.specular, glm::vec3(.7f, .8f, .9f));
    EXPECT_EQ(m.shininess, 50);
    EXPECT_EQ(m.emission, glm::vec3(4, 5, 6));
    EXPECT_EQ(m.reflection, 0);
    EXPECT_EQ(m.transmission, 0);
}

TEST(Mtl, illum_1_has_no_highlight) {
    EXPECT_EQ(mtl("Kd 1 1 1\nKs 1 1 1\nillum 1\n").specular, glm::vec3(0));
}

TEST(Mtl, illum_3_and_above_reflects_with_ks_whose_tint_is_the_base_color) {
    for (const int illum : {3, 5, 8}) {
        const SceneMaterial m = mtl("Kd 1 1 1\nKs .8 .4 .2\nillum " + std::to_string(illum) + "\n");
        EXPECT_EQ(m.reflection, 0.8f);
        EXPECT_EQ(m.base_color, glm::vec3(1, 0.5f, 0.25f));
        EXPECT_EQ(m.transmission, 0);
        EXPECT_FALSE(m.fresnel);
    }
    for (const int illum : {0, 1, 2}) EXPECT_EQ(mtl("Ks 1 1 1\nillum " + std::to_string(illum) + "\n").reflection, 0);
}

TEST(Mtl, illum_4_6_7_and_9_transmit_with_tf_and_ni) {
    for (const int illum : {4, 6, 7, 9}) {
        const SceneMaterial m = mtl("Ks .1 .1 .1\nTf .4 .8 .4\nNi 1.6\nillum " + std::to_string(illum) + "\n");
        EXPECT_EQ(m.transmission, 0.8f);
        EXPECT_EQ(m.base_color, glm::vec3(0.5f, 1, 0.5f));
        EXPECT_EQ(m.ior, 1.6f);
        EXPECT_EQ(m.reflection, 0.1f);
        EXPECT_EQ(m.fresnel, illum == 7);
    }
    EXPECT_EQ(mtl("Tf 1 1 1\nNi 1.6\nillum 5\n").transmission, 0);
}

TEST(Mtl, d_wins_over_tr_in_either_order) {
    EXPECT_EQ(mtl("d 0.75\nTr 0.9\nillum 2\n").transmission, 0.25f);
    EXPECT_EQ(mtl("Tr 0.9\nd 0.75\nillum 2\n").transmission, 0.25f);
    EXPECT_EQ(mtl("Tr 0.25\nillum 2\n").transmission, 0.25f);
}

TEST(Mtl, dissolves_without_refraction_unless_it_is_glass) {
    EXPECT_EQ(mtl("d 0.5\nNi 1.5\nillum 2\n").ior, 1);
    EXPECT_EQ(mtl("d 0.5\nNi 1.5\nillum 6\n").ior, 1.5f);
    EXPECT_EQ(mtl("d 0.5\nNi 1.5\nillum 6\n").transmission, 0.5f);
}

TEST(Mtl, reflection_and_transmission_sum_to_at_most_one) {
    const SceneMaterial m = mtl("Ks 1 1 1\nTf 1 1 1\nillum 7\n");
    EXPECT_EQ(m.reflection, 0.5f);
    EXPECT_EQ(m.transmission, 0.5f);
    const SceneMaterial bright = mtl("Ks 9 9 9\nTf .2 .2 .2\nillum 4\n");
    EXPECT_EQ(bright.reflection + bright.transmission, 1);
}

TEST(Mtl, without_illum_is_glass_or_mirror_where_its_numbers_say_so) {
    EXPECT_TRUE(mtl("Ks .04 .04 .04\nNi 1.6\nTf .95 .95 .95\n").fresnel);
    const SceneMaterial glossy_paint = mtl("Kd .5 .6 .7\nKs .7 .7 .7\nTf .3 .3 .3\n");
    EXPECT_EQ(glossy_paint.transmission + glossy_paint.reflection, 0);
    EXPECT_EQ(mtl("Kd .6 .6 .6\nNi 1.6\nd 0.05\n").ior, 1.6f);
    EXPECT_EQ(mtl("Ks 1 1 1\nNs 1000\n").reflection, 1);
    EXPECT_EQ(mtl("Kd .5 .5 .5\nKs 1 1 1\n").reflection, 0);
}

TEST(Mtl, counts_negative_and_not_finite_parameters_as_zero) {
    const SceneMaterial m = mtl("Kd -1 0.5 1e999\nNs -5\nNi 0\nTf 1 1 1\nillum 6\n");
    EXPECT_EQ(m.diffuse, glm::vec3(0, 0.5f, 0));
    EXPECT_EQ(m.shininess, 0);
    EXPECT_EQ(m.ior, 1);
}

TEST(Mtl, maps_that_are_not_read_are_named_in_a_warning) {
    const SceneFiles files;
    files.write("a.mtl", "newmtl m\nmap_Ks s.png\nmap_Bump b.png\nPr 0.5\nshader glossy\nmap_Kd -s 2 2 2 none.png\n");
    const Scene scene = files.obj("mtllib a.mtl\n" + square + "usemtl m\nf 1 2 3\n");
    EXPECT_TRUE(warns_of(scene, "map_Ks, map_Bump, Pr, the options of map_Kd, shader"));
    EXPECT_TRUE(warns_of(scene, "none.png\": No such file"));
    EXPECT_FALSE(scene.materials[1].diffuse_map);
}

TEST(Mtl, materials_change_from_face_to_face) {
    const SceneFiles files;
    files.write("a.mtl", "newmtl r\nKd 1 0 0\nnewmtl unused\nnewmtl g\nKd 0 1 0\n");
    const Scene scene =
        files.obj("mtllib a.mtl\n" + square + "f 1 2 3\nusemtl g\nf 1 2 3\nusemtl r\nf 1 2 3\nusemtl g\nf 1 2 3\n");
    EXPECT_EQ(scene.materials.size(), 3u);
    EXPECT_EQ(scene.triangles[0].material, 0u);
    EXPECT_EQ(scene.materials[scene.triangles[1].material].name, "g");
    EXPECT_EQ(scene.materials[scene.triangles[2].material].name, "r");
    EXPECT_EQ(scene.triangles[3].material, scene.triangles[1].material);
}

}  // namespace
}  // namespace raymill
