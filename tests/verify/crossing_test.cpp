// Crossings of a ray and a primitive, and how clear they are.
#include <gtest/gtest.h>

#include "verify/crossing.hpp"

namespace raymill::verify {
namespace {

/// The triangle (0,0,0), (1,0,0), (0,1,0), the sphere of radius 1 around (5,0,0), and the plane z = 0.
Scene three_primitives() {
    Scene scene;
    scene.materials.emplace_back();
    for (const glm::vec2& p : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)}) {
        Vertex vertex{};
        vertex.position[0] = p.x;
        vertex.position[1] = p.y;
        scene.vertices.push_back(vertex);
    }
    scene.triangles.push_back({{0, 1, 2}, 0, 0});
    scene.spheres.push_back({{5, 0, 0}, 1, 0, 0});
    scene.planes.push_back({{0, 0, 0}, {0, 0, 1}, 0, 0});
    return scene;
}

constexpr double exactly = 1e-14;  // double precision on numbers near one

TEST(Crossing, inside_a_triangle_is_certain_and_has_its_weights) {
    const auto all = crossings(three_primitives(), {{0.25, 0.5, 2}, {0, 0, -1}}, 0);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_NEAR(all[0].t, 2, exactly);
    EXPECT_NEAR(all[0].u, 0.25, exactly);
    EXPECT_NEAR(all[0].v, 0.5, exactly);
    EXPECT_NEAR(all[0].margin, 0.25, exactly);
    EXPECT_TRUE(all[0].certain());
    EXPECT_GT(all[0].clarity(), 1000);
}

TEST(Crossing, on_an_edge_is_possible_but_not_certain) {
    const auto all = crossings(three_primitives(), {{0.5, 0, 2}, {0, 0, -1}}, 0);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_TRUE(all[0].possible());
    EXPECT_FALSE(all[0].certain());
    EXPECT_LT(all[0].clarity(), 1);
}

TEST(Crossing, beside_a_triangle_is_impossible) {
    const auto all = crossings(three_primitives(), {{0.7, 0.7, 2}, {0, 0, -1}}, 0);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_FALSE(all[0].possible());
}

TEST(Crossing, behind_the_origin_is_impossible) {
    const auto all = crossings(three_primitives(), {{0.25, 0.5, -2}, {0, 0, -1}}, 0);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_FALSE(all[0].possible());
}

TEST(Crossing, along_a_triangle_s_plane_nothing_is_certain) {
    const auto all = crossings(three_primitives(), {{-1, 0.25, 0}, {1, 0, 0}}, 0);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_FALSE(all[0].certain());
}

TEST(Crossing, a_sphere_has_both_ends_of_the_chord_in_order) {
    const auto all = crossings(three_primitives(), {{0, 0, 0}, {1, 0, 0}}, 1);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_NEAR(all[0].t, 4, exactly);
    EXPECT_NEAR(all[1].t, 6, exactly);
    EXPECT_TRUE(all[0].certain() && all[1].certain());
}

TEST(Crossing, a_tangent_of_a_sphere_is_possible_but_not_certain) {
    const auto all = crossings(three_primitives(), {{0, 1, 0}, {1, 0, 0}}, 1);
    ASSERT_FALSE(all.empty());
    EXPECT_TRUE(all[0].possible());
    EXPECT_FALSE(all[0].certain());
}

TEST(Crossing, a_line_past_a_sphere_has_none) {
    EXPECT_TRUE(crossings(three_primitives(), {{0, 1.5, 0}, {1, 0, 0}}, 1).empty());
}

TEST(Crossing, a_plane_is_met_once) {
    const auto all = crossings(three_primitives(), {{3, 4, 5}, {0, 0.6, -0.8}}, 2);
    ASSERT_EQ(all.size(), 1u);
    EXPECT_NEAR(all[0].t, 6.25, exactly * 10);
    EXPECT_TRUE(all[0].certain());
}

}  // namespace
}  // namespace raymill::verify
