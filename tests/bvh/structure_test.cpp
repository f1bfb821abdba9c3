// Whatever it is built over, a tree keeps to the rules of its layout.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstring>

#include "meshes.hpp"
#include "scalar_traversal.hpp"
#include "tree_check.hpp"

namespace raymill::test {
namespace {

bool same_bytes(const auto& a, const auto& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

void expect_same_tree(const Bvh& a, const Bvh& b) {
    EXPECT_TRUE(same_bytes(a.nodes, b.nodes));
    EXPECT_TRUE(same_bytes(a.triangle_blocks, b.triangle_blocks));
    EXPECT_TRUE(same_bytes(a.sphere_blocks, b.sphere_blocks));
    EXPECT_EQ(a.statistics.surface_area_cost, b.statistics.surface_area_cost);
    EXPECT_EQ(a.statistics.depth, b.statistics.depth);
}

Mesh mixed(std::size_t triangles, std::size_t spheres) {
    Mesh mesh = random_soup(triangles, 11);
    mesh.spheres = random_spheres(spheres, 12).spheres;
    return mesh;
}

TEST(BvhStructure, nothing_to_hit_gives_an_empty_tree) {
    const Bvh bvh = Mesh{}.build();
    EXPECT_TRUE(bvh.nodes.empty() && bvh.triangle_blocks.empty() && bvh.sphere_blocks.empty());
    EXPECT_EQ(bvh.statistics.depth, 0);
    EXPECT_GT(bvh.bounds.lower.x, bvh.bounds.upper.x);
}

TEST(BvhStructure, a_single_triangle_gets_a_root_with_one_leaf) {
    Mesh mesh;
    mesh.add_triangle({1, 2, 3}, {4, 2, 3}, {1, 7, 5});
    const Bvh bvh = mesh.build();
    ASSERT_EQ(bvh.nodes.size(), 1u);
    EXPECT_EQ(bvh.nodes[0].child[0], CHILD_LEAF);
    for (int slot = 1; slot < BVH_WIDTH; ++slot) EXPECT_EQ(bvh.nodes[0].child[slot], 0u);
    EXPECT_EQ(bvh.bounds.lower, glm::vec3(1, 2, 3));
    EXPECT_EQ(bvh.bounds.upper, glm::vec3(4, 7, 5));
    EXPECT_EQ(bvh.statistics.depth, 1);
    expect_complete_tree(mesh, bvh);
}

TEST(BvhStructure, a_single_sphere_gets_a_root_with_one_sphere_leaf) {
    Mesh mesh;
    mesh.add_sphere({1, 2, 3}, 0.5f);
    const Bvh bvh = mesh.build();
    ASSERT_EQ(bvh.nodes.size(), 1u);
    EXPECT_EQ(bvh.nodes[0].child[0], CHILD_LEAF | CHILD_SPHERES);
    expect_complete_tree(mesh, bvh);
}

TEST(BvhStructure, random_soups_of_all_small_sizes_are_complete) {
    for (std::size_t count = 1; count <= 130; ++count) {
        const Mesh mesh = random_soup(count, static_cast<std::uint32_t>(count));
        expect_complete_trees(mesh);
    }
}

TEST(BvhStructure, a_large_soup_is_complete) {
    const Mesh mesh = random_soup(200000, 3, 0.01f);
    expect_complete_trees(mesh);
}

TEST(BvhStructure, spheres_alone_are_complete) {
    const Mesh mesh = random_spheres(3000, 5);
    const Bvh bvh = mesh.build();
    EXPECT_TRUE(bvh.triangle_blocks.empty());
    expect_complete_tree(mesh, bvh);
}

TEST(BvhStructure, triangles_and_spheres_share_a_tree_but_no_leaf) {
    for (const auto& [triangles, spheres] : {std::pair{1, 1}, {7, 1}, {1, 7}, {30, 34}, {2000, 3}, {1500, 1500}}) {
        const Mesh mesh = mixed(static_cast<std::size_t>(triangles), static_cast<std::size_t>(spheres));
        expect_complete_trees(mesh);
    }
}

TEST(BvhStructure, slivers_are_complete) {
    const Mesh mesh = slivers(5000, 7);
    expect_complete_trees(mesh);
}

TEST(BvhStructure, a_hundred_thousand_identical_triangles_fill_whole_leaves) {
    const Mesh mesh = identical_triangles(100000);
    for (const BvhQuality quality : QUALITIES) {
        const Bvh bvh = mesh.build(0, quality);
        expect_complete_tree(mesh, bvh);
        EXPECT_EQ(bvh.triangle_blocks.size(), 100000u / BVH_WIDTH);  // no lane is wasted
        EXPECT_LE(bvh.statistics.depth, 6);                          // 8^4 < 100000 / 64 leaves < 8^6
    }
}

TEST(BvhStructure, identical_triangles_among_identical_spheres_are_complete) {
    Mesh mesh = identical_triangles(1000);
    for (int i = 0; i < 1000; ++i) mesh.add_sphere({1.0f / 2, 1.0f / 2, 0}, 0.5f);
    expect_complete_trees(mesh);
}

TEST(BvhStructure, boxes_about_one_common_centre_are_complete) {
    const Mesh mesh = concentric_triangles(1000);
    expect_complete_trees(mesh);
}

TEST(BvhStructure, coincident_faces_of_different_triangles_are_complete) {
    Mesh mesh = uneven_sheet(20);
    const std::vector<Triangle> once = mesh.triangles;
    for (const Triangle& t : once) mesh.triangles.push_back({{t.vertex[2], t.vertex[1], t.vertex[0]}, 1, 1});
    expect_complete_trees(mesh);
}

TEST(BvhStructure, geometry_over_all_octaves_keeps_the_depth_limit) {
    const Mesh mesh = octaves();
    for (const BvhQuality quality : QUALITIES) {
        const Bvh bvh = mesh.build(0, quality);
        EXPECT_EQ(bvh.statistics.dropped_zero_area, 0u);
        expect_complete_tree(mesh, bvh);
        EXPECT_GT(bvh.statistics.depth, BVH_MAX_DEPTH / 2);  // else the limit would not have been tried
    }
}

TEST(BvhStructure, the_number_of_threads_does_not_change_a_byte) {
    std::vector<Mesh> meshes = {uneven_sheet(300), mixed(150000, 50000), octaves(), identical_triangles(70000)};
    // Zeros of both signs, where a minimum could depend on the order of its arguments.
    meshes.push_back(random_soup(100000, 9));
    for (Vertex& vertex : meshes.back().vertices) vertex.position[0] = vertex.position[1] < 0.5f ? -0.0f : 0.0f;
    for (const Mesh& mesh : meshes) {
        for (const BvhQuality quality : QUALITIES) {
            const Bvh one = mesh.build(1, quality);
            for (int repeat = 0; repeat < 3; ++repeat) expect_same_tree(one, mesh.build(2, quality));
            expect_same_tree(one, mesh.build(0, quality));
        }
    }
}

RC_GTEST_PROP(BvhStructure, any_small_lattice_geometry_is_complete_and_hit_like_by_brute_force, ()) {
    // Few coordinates: many coincident, flat and degenerate primitives.
    const auto coordinate = rc::gen::map(rc::gen::inRange(-3, 4), [](int i) { return static_cast<float>(i); });
    const auto count = *rc::gen::inRange<std::size_t>(0, 150);
    const auto values = *rc::gen::container<std::vector<float>>(9 * count, coordinate);
    const bool with_spheres = *rc::gen::arbitrary<bool>();
    Mesh mesh;
    std::size_t i = 0;
    const auto point = [&] {
        i += 3;
        return glm::vec3(values[i - 3], values[i - 2], values[i - 1]);
    };
    while (i + 9 <= values.size()) {
        const glm::vec3 a = point(), b = point(), c = point();
        mesh.add_triangle(a, b, c);
        if (with_spheres) mesh.add_sphere(a, 0.25f + static_cast<float>(i % 4));
    }
    for (const BvhQuality quality : QUALITIES) {
        const Bvh bvh = mesh.build(0, quality);
        const TreeFacts facts = check_tree(mesh, bvh);
        std::size_t found = 0;
        for (const int occurrences : facts.occurrences) {
            RC_ASSERT(occurrences == 0 || occurrences == 1);
            found += static_cast<std::size_t>(occurrences);
        }
        RC_ASSERT(found + bvh.statistics.dropped_zero_area == mesh.primitive_count());
        if (bvh.nodes.empty()) continue;
        for (const TestRay& ray : rays_at(bvh.bounds, 20, 1))
            RC_ASSERT(hit_by_tree(bvh, ray) == hit_by_brute_force(mesh, ray));
    }
}

}  // namespace
}  // namespace raymill::test
