// What cannot be hit is left out and counted; what is extreme but can be hit is kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "meshes.hpp"
#include "tree_check.hpp"

namespace raymill::test {
namespace {

constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();

TEST(BvhInput, triangles_with_vertices_that_are_not_finite_are_dropped_and_counted) {
    Mesh mesh = random_soup(50000, 1);
    const float bad[] = {NOT_A_NUMBER, INFINITY, -INFINITY};
    std::size_t spoiled = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 7, ++spoiled)
        mesh.vertices[3 * i + spoiled % 3].position[spoiled / 3 % 3] = bad[spoiled / 9 % 3];
    const Bvh bvh = mesh.build();
    EXPECT_EQ(bvh.statistics.dropped_not_finite, spoiled);
    EXPECT_EQ(bvh.statistics.dropped_zero_area, 0u);
    const TreeFacts facts = check_tree(mesh, bvh);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) ASSERT_EQ(facts.occurrences[i], i % 7 == 0 ? 0 : 1) << i;
}

TEST(BvhInput, other_vertex_attributes_may_be_anything) {
    Mesh mesh = random_soup(20, 1);
    for (Vertex& vertex : mesh.vertices) vertex.normal[0] = NOT_A_NUMBER;
    expect_complete_trees(mesh);
}

TEST(BvhInput, triangles_without_area_are_dropped_and_counted) {
    Mesh mesh = random_soup(10, 2);
    mesh.add_triangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3});  // one point
    mesh.add_triangle({1, 2, 3}, {1, 2, 3}, {4, 5, 6});  // two equal corners
    mesh.add_triangle({4, 5, 6}, {1, 2, 3}, {4, 5, 6});  // first and last corner equal
    mesh.add_triangle({0, 0, 0}, {1, 2, 3}, {2, 4, 6});  // on a line through the origin
    mesh.add_triangle({0.1f, 0.1f, 0.1f}, {0.3f, 0.3f, 0.3f}, {0.7f, 0.7f, 0.7f});
    mesh.add_triangle({0, 0, 0}, {1e-38f, 0, 0}, {0, 1e-38f, 0});                 // tiny, but an area: kept
    mesh.add_triangle({1, 1, 1}, {2, 2, 2}, {3, 3, std::nextafter(3.0f, 4.0f)});  // a step off the line: kept
    const Bvh bvh = mesh.build();
    EXPECT_EQ(bvh.statistics.dropped_zero_area, 5u);
    EXPECT_EQ(bvh.statistics.dropped_not_finite, 0u);
    const TreeFacts facts = check_tree(mesh, bvh);
    for (std::size_t id = 0; id < mesh.triangles.size(); ++id)
        EXPECT_EQ(facts.occurrences[id], id >= 10 && id < 15 ? 0 : 1) << id;
}

TEST(BvhInput, only_dropped_triangles_leave_an_empty_tree) {
    Mesh mesh;
    mesh.add_triangle({1, 2, 3}, {1, 2, 3}, {4, 5, 6});
    mesh.add_triangle({NOT_A_NUMBER, 2, 3}, {1, 2, 3}, {4, 5, 6});
    const Bvh bvh = mesh.build();
    EXPECT_TRUE(bvh.nodes.empty() && bvh.triangle_blocks.empty());
    EXPECT_EQ(bvh.statistics.dropped_zero_area, 1u);
    EXPECT_EQ(bvh.statistics.dropped_not_finite, 1u);
}

TEST(BvhInput, spheres_that_no_ray_can_hit_are_dropped_and_counted) {
    Mesh mesh = random_spheres(5, 3);
    mesh.add_sphere({NOT_A_NUMBER, 0, 0}, 1);
    mesh.add_sphere({0, 0, 0}, INFINITY);
    mesh.add_sphere({0, 0, 0}, 0);
    const Bvh bvh = mesh.build();
    EXPECT_EQ(bvh.statistics.dropped_not_finite, 2u);
    EXPECT_EQ(bvh.statistics.dropped_zero_area, 1u);
    const TreeFacts facts = check_tree(mesh, bvh);
    for (std::size_t id = 0; id < 5; ++id) EXPECT_EQ(facts.occurrences[id], 1);
}

TEST(BvhInput, a_small_sphere_far_out_is_enclosed_although_its_radius_is_rounded_away) {
    Mesh mesh;
    mesh.add_sphere({1e6f, -1e6f, 3e7f}, 1e-3f);
    const Bvh bvh = mesh.build();
    EXPECT_LT(bvh.bounds.lower.x, 1e6f);
    EXPECT_GT(bvh.bounds.upper.x, 1e6f);
    expect_complete_tree(mesh, bvh);  // compares with center +- radius in double
}

TEST(BvhInput, coordinates_up_to_the_largest_float_are_kept_apart) {
    Mesh mesh = random_soup(1000, 4);
    for (Vertex& vertex : mesh.vertices)
        for (float& x : vertex.position) x = std::min(std::max((x - 0.5f) * 2, -1.0f), 1.0f) * FLT_MAX;
    const Bvh bvh = mesh.build();
    expect_complete_tree(mesh, bvh);
    EXPECT_GT(bvh.nodes.size(), 10u);
    EXPECT_LT(bvh.triangle_blocks.size(), 1000u / 2);  // leaves hold two and more
}

/// Sum of the areas of all leaf boxes that lie in the cube of edge 4 about the origin, and how many do not.
struct LeafAreas {
    double near_origin = 0;
    int elsewhere = 0;
};

LeafAreas leaf_areas(const Bvh& bvh) {
    LeafAreas areas;
    for (const BvhNode& node : bvh.nodes)
        for (int slot = 0; slot < BVH_WIDTH; ++slot) {
            if (!(node.child[slot] & CHILD_LEAF)) continue;
            double size[3], reach = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const double lower = node.bounds[0][axis][slot], upper = node.bounds[1][axis][slot];
                size[axis] = upper - lower;
                reach = std::max({reach, -lower, upper});
            }
            if (reach <= 2)
                areas.near_origin += size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
            else
                ++areas.elsewhere;
        }
    return areas;
}

TEST(BvhInput, a_vertex_far_out_does_not_spoil_the_tree_of_the_rest) {
    Mesh mesh = uneven_sheet(50);
    const LeafAreas alone = leaf_areas(mesh.build());
    mesh.add_triangle({0, 0, 0}, {1e30f, 0, 0}, {0, 1e30f, 1e30f});
    mesh.add_triangle({-1e30f, -1e30f, -1e30f}, {1e30f, 0, 1e20f}, {0, -1e30f, -1e30f});
    const Bvh bvh = mesh.build();
    expect_complete_tree(mesh, bvh);
    const LeafAreas found = leaf_areas(bvh);
    EXPECT_LE(found.elsewhere, 2);
    // Relative to the scene these areas are 1e-60: floats would lose them. Other splits near the root may cost a
    // little.
    EXPECT_LT(found.near_origin, 1.2 * alone.near_origin);
}

TEST(BvhInput, denormal_coordinates_are_kept) {
    Mesh mesh = random_soup(500, 6);
    for (Vertex& vertex : mesh.vertices)
        for (float& x : vertex.position) x *= 1e-40f;
    const Bvh bvh = mesh.build();
    EXPECT_EQ(bvh.statistics.dropped_not_finite, 0u);
    const TreeFacts facts = check_tree(mesh, bvh);
    std::size_t kept = 0;
    for (const int occurrences : facts.occurrences) kept += static_cast<std::size_t>(occurrences);
    EXPECT_EQ(kept + bvh.statistics.dropped_zero_area, 500u);
}

}  // namespace
}  // namespace raymill::test
