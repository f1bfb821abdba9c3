// Solids are closed and face outwards, mirrored or not; transforms and chord errors are as stated.
#include "scene/shapes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <map>
#include <tuple>

#include "scene_files.hpp"

namespace raymill {
namespace {

constexpr double pi = glm::pi<double>();

using Point = std::tuple<float, float, float>;

Point point_of(const Scene& scene, const Triangle& triangle, int corner) {
    const glm::vec3 p = position(scene, triangle, corner);
    return {p.x, p.y, p.z};
}

/// How many directed edges have no opposite, or occur more than once.
std::size_t open_edges(const Scene& scene) {
    std::map<std::pair<Point, Point>, int> edges;
    for (const Triangle& t : scene.triangles)
        for (int c = 0; c < 3; ++c) ++edges[{point_of(scene, t, c), point_of(scene, t, (c + 1) % 3)}];
    std::size_t open = 0;
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        open += count != 1 || opposite == edges.end() || opposite->second != 1;
    }
    return open;
}

double signed_volume(const Scene& scene) {
    double volume = 0;
    for (const Triangle& t : scene.triangles) {
        const glm::dvec3 a(position(scene, t, 0)), b(position(scene, t, 1)), c(position(scene, t, 2));
        volume += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return volume;
}

struct Solid {
    const char* name;
    const char* keys;
    double volume;  // exact
};

void PrintTo(const Solid& solid, std::ostream* out) {
    *out << solid.name;
}

const Solid solids[] = {
    {"box", "shape = 'box'\nmin = [-1, 0, 2]\nmax = [1, 3, 3]", 6},
    {"cylinder", "shape = 'cylinder'\nbase = [1, 0, 0]\ntop = [1, 2, 2]\nradius = 0.5", pi * 0.25 * std::sqrt(8.0)},
    {"cone", "shape = 'cone'\nbase = [0, 1, 0]\ntop = [3, 1, 0]\nradius = 2", pi * 4},
    {"cone_down", "shape = 'cone'\nbase = [0, 0, 0]\ntop = [0, 0, -3]\nradius = 1", pi},
    {"ellipsoid", "shape = 'sphere'\ncenter = [1, 1, 1]\nradius = 1\nscale = [1, 2, 3]", 4 * pi / 3 * 6},
    {"lathe_cone", "shape = 'lathe'\nprofile = [[0, 0], [1, 0], [0, 2]]\nsegments = 100\ncenter = [3, 1, 0]",
     2 * pi / 3},
    {"lathe_ring", "shape = 'lathe'\nprofile = [[2, 0], [3, 0], [3, 1], [2, 1], [2, 0]]\nsegments = 100", 5 * pi},
};

const char* const placements[] = {"", "matrix = [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n",
                                  "rotate = [10, 20, 30]\nmatrix = [-1,0,0,5, 0,-1,0,5, 0,0,-1,5, 0,0,0,1]\n",
                                  "rotate = [90, 0, 45]\n", "matrix = [0,1,0,2, 1,0,0,3, 0,0,1,4, 0,0,0,1]\n"};

class ClosedSolid : public testing::TestWithParam<std::tuple<Solid, const char*>> {};

TEST_P(ClosedSolid, has_every_edge_twice_and_the_right_volume_inside) {
    const auto& [solid, placement] = GetParam();
    const Scene scene = SceneFiles().toml(std::string("[[object]]\n") + solid.keys + "\n" + placement);
    ASSERT_GT(scene.triangles.size(), 11u);
    EXPECT_EQ(open_edges(scene), 0u);
    // Chord errors of 1e-3 of the radius in both radial directions, and of pi^2 / (2 * 100^2) for the lathes.
    EXPECT_NEAR(signed_volume(scene) / solid.volume, 1, 4e-3);
}

INSTANTIATE_TEST_SUITE_P(Shapes, ClosedSolid,
                         testing::Combine(testing::ValuesIn(solids), testing::ValuesIn(placements)),
                         [](const auto& info) {
                             return std::string(std::get<0>(info.param).name) + "_" + std::to_string(info.index);
                         });

class SmoothSolid : public testing::TestWithParam<std::tuple<Solid, const char*>> {};

TEST_P(SmoothSolid, has_vertex_normals_on_the_outside) {
    const auto& [solid, placement] = GetParam();
    const Scene scene = SceneFiles().toml(std::string("[[object]]\n") + solid.keys + "\n" + placement);
    for (const Triangle& t : scene.triangles)
        for (int c = 0; c < 3; ++c) {
            const glm::vec3 n = vertex_normal(scene, t, c);
            EXPECT_NEAR(glm::length(n), 1, 1e-6);  // float rounding of a unit vector
            // The widest step between neighbours is the 1:3 ellipsoid's, below 30 degrees.
            EXPECT_GT(glm::dot(n, face_normal(scene, t)), 0.85f);
        }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SmoothSolid,
                         testing::Combine(testing::ValuesIn(solids), testing::ValuesIn(placements)),
                         [](const auto& info) {
                             return std::string(std::get<0>(info.param).name) + "_" + std::to_string(info.index);
                         });

TEST(Sphere, stays_a_sphere_under_rotation_uniform_scale_and_mirroring) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'sphere'\ncenter = [1, 0, 0]\nradius = 0.5\n"
        "scale = [-2, 2, 2]\nrotate = [0, 0, 90]\ntranslate = [10, 0, 0]\n");
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_EQ(vec(scene.spheres[0].center), glm::vec3(10, -2, 0));  // (-2, 0, 0) turned by 90 degrees about z
    EXPECT_EQ(scene.spheres[0].radius, 1);
    EXPECT_EQ(scene.objects[0].chord_error, 0);
}

TEST(Sphere, under_uneven_scale_keeps_its_stated_chord_error) {
    const Scene scene =
        SceneFiles().toml("[[object]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 2\nscale = [1, 1, 1.5]\n");
    ASSERT_TRUE(scene.spheres.empty());
    EXPECT_LE(scene.objects[0].chord_error, 1e-3 * 2 * 1.5);
    double farthest = 0;
    for (const Triangle& t : scene.triangles) {
        const glm::dvec3 middle =
            glm::dvec3(position(scene, t, 0) + position(scene, t, 1) + position(scene, t, 2)) / 3.0;
        // Back to the unit sphere, where the distance is the radius lost; it grows by 3 at most on the way back.
        const glm::dvec3 unit = middle / glm::dvec3(2, 2, 3);
        farthest = std::max(farthest, 3 * (1 - glm::length(unit)));
    }
    EXPECT_LE(farthest, scene.objects[0].chord_error);
    EXPECT_GT(farthest, 0.25 * scene.objects[0].chord_error);  // stated, not overstated
}

TEST(Plane, keeps_its_inside_under_mirroring_and_uneven_scale) {
    const Scene scene =
        SceneFiles().toml("[[object]]\nshape = 'plane'\npoint = [0, 1, 0]\nnormal = [1, 1, 0]\nscale = [1, -2, 1]\n");
    ASSERT_EQ(scene.planes.size(), 1u);
    EXPECT_EQ(vec(scene.planes[0].point), glm::vec3(0, -2, 0));
    // x + y = 1 becomes x - y / 2 = 1: normal (1, -1/2).
    const glm::vec3 expected = glm::normalize(glm::vec3(1, -0.5, 0));
    EXPECT_NEAR(glm::distance(vec(scene.planes[0].normal), expected), 0, 1e-7);  // one float rounding
}

TEST(Cylinder, states_its_chord_error_in_world_units) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'cylinder'\nbase = [0, 0, 0]\ntop = [0, 1, 0]\nradius = 2\nscale = 10\n");
    const double exact = 20 * (1 - std::cos(pi / circle_segments));
    EXPECT_NEAR(scene.objects[0].chord_error, exact, 1e-12);  // double rounding
    EXPECT_LE(exact, 1e-3 * 20);
    for (const Vertex& v : scene.vertices) {
        const double r = std::hypot(v.position[0], v.position[2]);
        // On the axis (cap centres) or on the exact surface, to float rounding at 20.
        EXPECT_TRUE(r < 1e-5 || std::abs(r - 20) < 1e-5) << r;
    }
}

TEST(Cylinder, is_smooth_around_and_flat_on_its_caps) {
    const Scene scene =
        SceneFiles().toml("[[object]]\nshape = 'cylinder'\nbase = [0, 0, 0]\ntop = [0, 1, 0]\nradius = 1\n");
    for (const Triangle& t : scene.triangles) {
        const bool cap = std::abs(face_normal(scene, t).y) > 0.5f;
        for (int c = 0; c < 3; ++c) {
            const glm::vec3 p = position(scene, t, c);
            const glm::vec3 expected = cap ? glm::vec3(0, p.y > 0.5f ? 1 : -1, 0) : glm::vec3(p.x, 0, p.z);
            EXPECT_NEAR(glm::distance(vertex_normal(scene, t, c), expected), 0, 1e-6);  // float rounding
        }
    }
}

TEST(Cone, has_normals_square_to_its_slope) {
    const Scene scene =
        SceneFiles().toml("[[object]]\nshape = 'cone'\nbase = [0, 0, 0]\ntop = [0, 2, 0]\nradius = 1\n");
    for (const Triangle& t : scene.triangles) {
        if (face_normal(scene, t).y < -0.5f) continue;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(vertex_normal(scene, t, c).y, 1 / std::sqrt(5.0), 1e-6);  // float rounding
    }
}

TEST(RectangleAndDisk, face_the_side_of_their_normal) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'rectangle'\ncenter = [1, 2, 3]\nedge_u = [2, 0, 0]\nedge_v = [0, 4, 0]\n"
        "[[object]]\nshape = 'disk'\ncenter = [0, 0, 0]\nnormal = [0, -3, 0]\nradius = 2\n");
    ASSERT_EQ(scene.triangles.size(), 2 + circle_segments);
    double area = 0;
    for (const Triangle& t : scene.triangles) {
        const glm::vec3 expected = t.object == 0 ? glm::vec3(0, 0, 1) : glm::vec3(0, -1, 0);
        EXPECT_NEAR(glm::distance(face_normal(scene, t), expected), 0, 1e-6);  // float rounding
        if (t.object == 0)
            area += 0.5 * glm::length(glm::cross(position(scene, t, 1) - position(scene, t, 0),
                                                 position(scene, t, 2) - position(scene, t, 0)));
    }
    EXPECT_NEAR(area, 8, 1e-5);  // float rounding
    EXPECT_EQ(position(scene, scene.triangles[0], 0), glm::vec3(0, 0, 3));
    EXPECT_EQ(position(scene, scene.triangles[0], 2), glm::vec3(2, 4, 3));
}

TEST(Lathe, has_its_outside_away_from_the_axis_where_the_profile_goes_up) {
    const auto normal_at_first = [](const char* profile) {
        const Scene scene = SceneFiles().toml(std::string("[[object]]\nshape = 'lathe'\nprofile = ") + profile + "\n");
        const Triangle& t = scene.triangles[0];
        const glm::vec3 p = position(scene, t, 0);
        return glm::dot(face_normal(scene, t), glm::normalize(glm::vec3(p.x, 0, p.z)));
    };
    EXPECT_GT(normal_at_first("[[1, 0], [1, 2]]"), 0.99f);  // a facet's normal is off by pi / 64
    EXPECT_LT(normal_at_first("[[1, 2], [1, 0]]"), -0.99f);
}

TEST(Lathe, keeps_creases_above_its_smooth_angle) {
    const auto distinct_normals_at_rim = [](const char* angle) {
        const Scene scene = SceneFiles().toml(
            std::string("[[object]]\nshape = 'lathe'\nprofile = [[1, 0], [1, 1], [0, 1]]\nsmooth_angle = ") + angle +
            "\n");
        std::size_t level = 0;  // vertices on the rim whose normal is straight up
        for (const Vertex& v : scene.vertices) level += v.position[1] == 1 && v.normal[1] > 0.999f;
        return level;
    };
    EXPECT_GT(distinct_normals_at_rim("40"), 64u);
    EXPECT_LE(distinct_normals_at_rim("100"), 64u);  // only the middle of the lid, once a segment
}

TEST(Transforms, run_scale_then_x_then_y_then_z_then_translate_then_matrix) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'triangle'\nvertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
        "scale = [2, 3, 4]\nrotate = [90, 90, 90]\ntranslate = [10, 20, 30]\n"
        "matrix = [0,-1,0,0, 1,0,0,0, 0,0,1,5, 0,0,0,1]\n");
    const Triangle& t = scene.triangles[0];
    // (2,0,0): x keeps it, y takes it to (0,0,-2), z keeps it; + (10,20,30) = (10,20,28); (-y, x, z + 5).
    EXPECT_EQ(position(scene, t, 0), glm::vec3(-20, 10, 33));
    // (0,3,0): x to (0,0,3), y to (3,0,0), z to (0,3,0); (10,23,30).
    EXPECT_EQ(position(scene, t, 1), glm::vec3(-23, 10, 35));
    // (0,0,4): x to (0,-4,0), y keeps it, z to (4,0,0); (14,20,30).
    EXPECT_EQ(position(scene, t, 2), glm::vec3(-20, 14, 35));
}

TEST(Transforms, carry_normals_by_the_inverse_transpose) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'triangle'\nvertices = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
        "normals = [[1, 1, 0], [1, 1, 1], [0, 0, 2]]\nscale = [2, 1, 1]\n");
    const Triangle& t = scene.triangles[0];
    // Float rounding of unit vectors.
    EXPECT_NEAR(glm::distance(vertex_normal(scene, t, 0), glm::normalize(glm::vec3(0.5, 1, 0))), 0, 1e-6);
    EXPECT_NEAR(glm::distance(vertex_normal(scene, t, 1), glm::normalize(glm::vec3(0.5, 1, 1))), 0, 1e-6);
    EXPECT_NEAR(glm::distance(vertex_normal(scene, t, 2), glm::vec3(0, 0, 1)), 0, 1e-6);
}

}  // namespace
}  // namespace raymill
