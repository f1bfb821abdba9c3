#include "scene/mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scene_files.hpp"

namespace raymill {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles triangulated(const std::vector<glm::dvec3>& corners) {
    Triangles triangles;
    triangulate(corners, triangles);
    return triangles;
}

/// Signed area in the xy plane: positive for counter-clockwise.
double area(const std::vector<glm::dvec3>& p, const std::array<std::uint32_t, 3>& t) {
    const glm::dvec3 u = p[t[1]] - p[t[0]], v = p[t[2]] - p[t[0]];
    return 0.5 * (u.x * v.y - u.y * v.x);
}

TEST(Triangulation, of_a_concave_quad_takes_the_diagonal_inside) {
    const std::vector<glm::dvec3> dart = {{0, 0, 0}, {4, -1, 0}, {1, 0, 0}, {4, 1, 0}};
    for (std::size_t turn = 0; turn < 4; ++turn) {
        std::vector<glm::dvec3> corners;
        for (std::size_t i = 0; i < 4; ++i) corners.push_back(dart[(i + turn) % 4]);
        const Triangles triangles = triangulated(corners);
        ASSERT_EQ(triangles.size(), 2u);
        for (const auto& t : triangles) EXPECT_NEAR(area(corners, t), 0.5, 1e-15) << turn;  // exact but for rounding
    }
}

TEST(Triangulation, of_a_convex_quad_takes_the_shorter_diagonal) {
    EXPECT_EQ(triangulated({{0, 0, 0}, {3, 0, 0}, {4, 1, 0}, {1, 1, 0}}), (Triangles{{0, 1, 3}, {1, 2, 3}}));
}

TEST(Triangulation, of_concave_polygons_covers_each_point_once) {
    // A comb: every tooth is an ear, every gap a reflex corner.
    std::vector<glm::dvec3> comb = {{0, -1, 0}, {20, -1, 0}};
    for (int i = 20; i >= 0; --i) comb.emplace_back(i, i % 2 ? 0 : 5, 0);
    double total = 0;
    for (const auto& t : triangulated(comb)) {
        EXPECT_GE(area(comb, t), 0);
        total += area(comb, t);
    }
    EXPECT_EQ(triangulated(comb).size(), comb.size() - 2);
    EXPECT_NEAR(total, 20 + 20 * 2.5, 1e-12);  // double rounding of a handful of sums
}

TEST(Triangulation, keeps_the_winding_in_any_plane) {
    const std::vector<glm::dvec3> flat = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5, 0}, {0, 2, 0}};
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            std::vector<glm::dvec3> corners;
            glm::dvec3 normal(0);
            normal[axis] = sign;
            for (const glm::dvec3& p : flat) {
                glm::dvec3 q(7);
                q[(axis + 1) % 3] += sign * p.x;
                q[(axis + 2) % 3] += p.y;
                corners.push_back(q);
            }
            for (const auto& t : triangulated(corners))
                EXPECT_GT(glm::dot(normal, glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]])),
                          0);
        }
}

TEST(Triangulation, ends_for_polygons_that_cross_themselves_or_collapse) {
    std::vector<glm::dvec3> star, point(1000, glm::dvec3(1)), broken(50, glm::dvec3(NAN));
    for (int i = 0; i < 1001; ++i) star.emplace_back(std::cos(i * 2.2), std::sin(i * 2.2), 0);
    EXPECT_EQ(triangulated(star).size(), star.size() - 2);
    EXPECT_EQ(triangulated(point).size(), point.size() - 2);
    EXPECT_EQ(triangulated(broken).size(), broken.size() - 2);
}

/// Two squares that meet at the y axis under `fold` degrees.
std::string folded(double fold, const std::string& more) {
    const double c = std::cos(fold * M_PI / 180), s = std::sin(fold * M_PI / 180);
    return "[[object]]\nshape = 'mesh'\nvertices = [[-1,0,0], [0,0,0], [0,1,0], [-1,1,0], [" + std::to_string(c) +
           ",0," + std::to_string(-s) + "], [" + std::to_string(c) + ",1," + std::to_string(-s) +
           "]]\nfaces = [[0,1,2,3], [1,4,5,2]]\n" + more;
}

TEST(InlineMesh, without_normals_is_flat_and_shares_its_vertices) {
    const Scene scene = SceneFiles().toml(folded(30, ""));
    EXPECT_EQ(scene.triangles.size(), 4u);
    ASSERT_EQ(scene.vertices.size(), 6u);
    for (const Vertex& v : scene.vertices) EXPECT_EQ(vec(v.normal), glm::vec3(0));
}

TEST(InlineMesh, with_a_smooth_angle_above_the_fold_averages_across_it) {
    const Scene scene = SceneFiles().toml(folded(30, "smooth_angle = 31\n"));
    EXPECT_EQ(scene.vertices.size(), 6u);
    for (const Vertex& v : scene.vertices) {
        if (v.position[0] != 0) continue;
        EXPECT_NEAR(v.normal[0], std::sin(15 * M_PI / 180), 1e-5);  // six digits in the text
    }
}

TEST(InlineMesh, with_a_smooth_angle_below_the_fold_keeps_the_crease) {
    const Scene scene = SceneFiles().toml(folded(30, "smooth_angle = 29\n"));
    EXPECT_EQ(scene.vertices.size(), 8u);
    for (const Triangle& t : scene.triangles)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(glm::distance(vertex_normal(scene, t, c), face_normal(scene, t)), 0, 1e-6);  // float rounding
}

TEST(InlineMesh, smooths_across_vertices_that_are_written_twice) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'mesh'\nsmooth_angle = 91\n"
        "vertices = [[-1,0,0], [0,0,0], [0,1,0],  [0,0,0], [0,0,-1], [0,1,0]]\nfaces = [[0,1,2], [3,4,5]]\n");
    // The faces' normals are (0,0,1) and (1,0,0); their angles at (0,0,0) are both right, and so the mean is diagonal.
    EXPECT_NEAR(vertex_normal(scene, scene.triangles[0], 1).x, std::sqrt(0.5), 1e-6);  // float rounding
    EXPECT_NEAR(vertex_normal(scene, scene.triangles[1], 0).z, std::sqrt(0.5), 1e-6);
}

TEST(InlineMesh, flips_its_faces_under_a_mirror_but_not_its_outside) {
    const char* const mesh =
        "[[object]]\nshape = 'mesh'\nvertices = [[0,0,0],[1,0,0],[0,1,0]]\nnormals = [[0,0,1],[0,0,1],[0,0,1]]\n"
        "faces = [[0,1,2]]\n";
    const Scene scene = SceneFiles().toml(std::string(mesh) + "scale = [-1, 1, 1]\n");
    EXPECT_EQ(face_normal(scene, scene.triangles[0]), glm::vec3(0, 0, 1));
    EXPECT_EQ(vertex_normal(scene, scene.triangles[0], 0), glm::vec3(0, 0, 1));
}

}  // namespace
}  // namespace raymill
