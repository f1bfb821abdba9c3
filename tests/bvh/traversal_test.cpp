// Through the tree a ray finds exactly what it finds among all primitives: the same id at the same distance, bit for
// bit, as both ways compute with the same functions.
#include <gtest/gtest.h>

#include "meshes.hpp"
#include "scalar_traversal.hpp"

namespace raymill::test {
namespace {

/// hit_share: of the rays, at least: a test on rays that all miss would prove nothing.
void expect_same_hits(const Mesh& mesh, int ray_count, double hit_share) {
    const Bvh fast = mesh.build(0, BvhQuality::fast), high = mesh.build(0, BvhQuality::high);
    int hits = 0, rays = 0;
    for (const TestRay& ray : rays_at(high.bounds, ray_count, 42)) {
        const TestHit expected = hit_by_brute_force(mesh, ray);
        for (const Bvh* bvh : {&fast, &high}) {
            const TestHit found = hit_by_tree(*bvh, ray);
            ASSERT_EQ(found.primitive, expected.primitive) << "ray " << rays;
            ASSERT_EQ(found.t, expected.t) << "ray " << rays;
        }
        hits += expected.primitive != NO_INDEX;
        ++rays;
    }
    EXPECT_GE(hits, hit_share * rays);
}

TEST(BvhTraversal, random_soup_is_hit_like_by_brute_force) {
    expect_same_hits(random_soup(3000, 1), 1000, 0.5);
}

TEST(BvhTraversal, an_uneven_sheet_is_hit_like_by_brute_force) {
    expect_same_hits(uneven_sheet(40), 1000, 0.3);
}

TEST(BvhTraversal, slivers_are_hit_like_by_brute_force) {
    Mesh mesh = slivers(3000, 2);
    // A triangle 1e-6 wide is hardly ever hit by a random ray: something to hit lies around them.
    mesh.add_sphere({0.5f, 0.5f, 0.5f}, 0.4f);
    expect_same_hits(mesh, 1000, 0.3);
}

TEST(BvhTraversal, spheres_are_hit_like_by_brute_force) {
    expect_same_hits(random_spheres(2000, 3), 1000, 0.5);
}

TEST(BvhTraversal, a_mixed_scene_is_hit_like_by_brute_force) {
    Mesh mesh = random_soup(1000, 4, 0.05f);
    mesh.spheres = random_spheres(1000, 5).spheres;
    expect_same_hits(mesh, 1000, 0.5);
}

TEST(BvhTraversal, of_identical_triangles_the_first_is_hit) {
    const Mesh mesh = identical_triangles(5000);
    const TestHit hit = hit_by_tree(mesh.build(), {{0.25, 0.25, 1}, {0, 0, -1}});
    EXPECT_EQ(hit.primitive, 0u);
    EXPECT_EQ(hit.t, 1.0);
}

TEST(BvhTraversal, concentric_triangles_are_hit_like_by_brute_force) {
    expect_same_hits(concentric_triangles(1000), 500, 0.3);
}

TEST(BvhTraversal, huge_coordinates_are_hit_like_by_brute_force) {
    Mesh mesh = random_soup(2000, 6);
    for (Vertex& vertex : mesh.vertices)
        for (float& x : vertex.position) x *= 1e37f;
    expect_same_hits(mesh, 500, 0.5);
}

TEST(BvhTraversal, a_modelled_cat_is_hit_like_by_brute_force) {
    const auto mesh = read_obj(RAYMILL_TEST_DATA "/obj/egyptcat/egyptcat.obj");
    if (!mesh) GTEST_SKIP() << "no " RAYMILL_TEST_DATA "/obj/egyptcat/egyptcat.obj";
    expect_same_hits(*mesh, 500, 0.1);
}

}  // namespace
}  // namespace raymill::test
