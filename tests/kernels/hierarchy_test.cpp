// The hit found through the hierarchy is, to the last bit, the one that testing every primitive by the same arithmetic
// finds: on pleasant and on nasty geometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "kernel_rig.hpp"
#include "queues.hpp"
#include "random.hpp"

namespace raymill::test {
namespace {

glm::vec3 on_an_edge(const Scene& scene, Random& random) {
    const uint* corners = scene.triangles[random.below(static_cast<uint>(scene.triangles.size()))].vertex;
    const glm::vec3 a = vec3_of(scene.vertices[corners[0]].position), b = vec3_of(scene.vertices[corners[1]].position);
    return a + random.in(0, 1) * (b - a);
}

/// Rays through the scene's bounds from all around and from within, some parallel to axes, some at exact vertices.
std::vector<Ray> rays_through(const Scene& scene, std::size_t count, std::uint32_t seed) {
    Random random(seed);
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres);
    const glm::vec3 center = 0.5f * bvh.bounds.lower + 0.5f * bvh.bounds.upper;
    const glm::vec3 half = 0.5f * bvh.bounds.upper - 0.5f * bvh.bounds.lower;
    std::vector<Ray> rays;
    for (uint i = 0; rays.size() < count; ++i) {
        const glm::vec3 origin = center + random.in(0, 2) * half * random.direction() * (i % 3 ? 1.0f : 20.0f);
        glm::vec3 target = center + half * random.in_cube(-1, 1);
        if (i % 4 == 0 && !scene.vertices.empty())
            target = vec3_of(scene.vertices[random.below(static_cast<uint>(scene.vertices.size()))].position);
        if (i % 4 == 1 && !scene.triangles.empty()) target = on_an_edge(scene, random);
        glm::vec3 direction = towards(origin, target);
        if (i % 7 == 0) direction = glm::vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * (i % 2 ? 1.0f : -1.0f);
        if (std::isfinite(direction.x + direction.y + direction.z)) rays.push_back(make_ray(origin, direction));
    }
    return rays;
}

/// Chunks of rays that a kernel may trace together: from one point, or exactly parallel to an axis through vertices and
/// points around them.
std::vector<Ray> coherent_rays(const Scene& scene, std::size_t count, std::uint32_t seed) {
    Random random(seed);
    std::vector<Ray> rays;
    for (const Ray& first : rays_through(scene, count / CHUNK, seed)) {
        const glm::vec3 origin = vec3_of(first.origin), direction = vec3_of(first.direction);
        const bool parallel = random.below(2) && !scene.vertices.empty();
        const uint axis = random.below(3);
        const float sign = random.below(2) ? 1.0f : -1.0f;
        for (uint i = 0; i < CHUNK; ++i) {
            glm::vec3 from = origin, along = glm::normalize(direction + 0.02f * random.in_cube(-1, 1));
            if (parallel) {
                from = vec3_of(scene.vertices[random.below(static_cast<uint>(scene.vertices.size()))].position);
                from[static_cast<int>(axis)] = origin[static_cast<int>(axis)];
                // Half of the chunks lie in one plane, in which sides of boxes lie as well.
                if (i > 0 && rays.size() / CHUNK % 2) {
                    const int across = static_cast<int>((axis + 1) % 3);
                    from[across] = rays.back().origin[across];
                }
                along = glm::vec3(axis == 0, axis == 1, axis == 2) * sign;
            }
            if (std::isfinite(from.x + from.y + from.z)) rays.push_back(make_ray(from, along));
        }
    }
    return rays;
}

/// Whether each ray hits the same alone in a crowd of others as among its like.
void expect_company_not_to_matter(const Scene& scene, std::uint32_t seed) {
    const std::vector<Ray> rays = coherent_rays(scene, 32768, seed);
    const std::size_t stride = 4099;  // a prime that divides no number of rays here
    std::vector<Ray> mixed;
    for (std::size_t i = 0; i < rays.size(); ++i) mixed.push_back(rays[i * stride % rays.size()]);
    const auto together = KernelRig(scene).intersect(rays).hits;
    const auto apart = KernelRig(scene).intersect(mixed).hits;
    const auto each = KernelRig(scene, uncullable_bvh(scene)).intersect(mixed).hits;
    std::size_t wrong = 0, culled = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        wrong += !same_bits(together[i * stride % rays.size()], apart[i]);
        culled += !same_bits(each[i], apart[i]);
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(culled, 0u);
}

void expect_same_hits(const Scene& scene, std::size_t count, std::uint32_t seed) {
    const std::vector<Ray> rays = rays_through(scene, count, seed);
    const auto each = KernelRig(scene, uncullable_bvh(scene)).intersect(rays).hits;
    for (const BvhQuality quality : QUALITIES) {
        const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, {0, quality});
        const auto through = KernelRig(scene, bvh).intersect(rays).hits;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (same_bits(through[i], each[i])) continue;
            if (++wrong <= 3)
                ADD_FAILURE() << "ray " << i << ": through the hierarchy " << through[i].primitive << " at "
                              << through[i].t << ", testing each " << each[i].primitive << " at " << each[i].t;
        }
        EXPECT_EQ(wrong, 0u);
    }
    const auto missing = std::count_if(each.begin(), each.end(), [](const Hit& h) { return h.primitive == NO_INDEX; });
    // Else the rays say nothing; slivers are met by few.
    EXPECT_LT(static_cast<std::size_t>(missing), rays.size() - rays.size() / 1000);
}

Mesh coincident_sheets() {
    Mesh mesh = uneven_sheet(12);
    const std::vector<Triangle> once = mesh.triangles;
    for (int copy = 0; copy < 3; ++copy)
        for (const Triangle& t : once)
            mesh.triangles.push_back({{t.vertex[copy % 3], t.vertex[(copy + 1) % 3], t.vertex[(copy + 2) % 3]}, 0, 0});
    return mesh;
}

Mesh scaled(Mesh mesh, float factor, const glm::vec3& shift) {
    for (Vertex& vertex : mesh.vertices) store(vertex.position, vec3_of(vertex.position) * factor + shift);
    for (Sphere& sphere : mesh.spheres) {
        store(sphere.center, vec3_of(sphere.center) * factor + shift);
        sphere.radius *= factor;
    }
    return mesh;
}

TEST(Hierarchy, finds_the_same_hits_in_random_triangles) {
    expect_same_hits(scene_of(random_soup(3000, 1)), 100000, 1);
}
TEST(Hierarchy, finds_the_same_hits_in_large_triangles) {
    expect_same_hits(scene_of(random_soup(500, 2, 0.8f)), 100000, 2);
}
TEST(Hierarchy, finds_the_same_hits_in_slivers) {
    expect_same_hits(scene_of(slivers(2000, 3)), 200000, 3);
}
TEST(Hierarchy, finds_the_same_hits_in_an_uneven_sheet) {
    expect_same_hits(scene_of(uneven_sheet(40)), 100000, 4);
}
TEST(Hierarchy, finds_the_same_hits_in_spheres) {
    expect_same_hits(scene_of(random_spheres(2000, 5)), 100000, 5);
}
TEST(Hierarchy, finds_the_same_hits_in_concentric_triangles) {
    expect_same_hits(scene_of(concentric_triangles(300)), 100000, 6);
}
TEST(Hierarchy, finds_the_same_hits_in_coincident_sheets) {
    expect_same_hits(scene_of(coincident_sheets()), 100000, 7);
}
TEST(Hierarchy, finds_the_same_hits_at_a_tiny_scale) {
    expect_same_hits(scene_of(scaled(random_soup(1000, 8), 1e-5f, {})), 50000, 8);
}
TEST(Hierarchy, finds_the_same_hits_far_from_the_origin) {
    expect_same_hits(scene_of(scaled(random_soup(1000, 9), 10, glm::vec3(1e5f, -1e5f, 1e5f))), 50000, 9);
}
TEST(Hierarchy, finds_the_same_hits_in_slivers_far_from_the_origin) {
    expect_same_hits(scene_of(scaled(slivers(1000, 10), 1000, glm::vec3(-1e4f, 1e4f, 3e4f))), 50000, 10);
}

TEST(Hierarchy, finds_the_same_hits_in_triangles_spheres_and_planes) {
    Mesh mesh = random_soup(800, 11);
    mesh.spheres = random_spheres(800, 12).spheres;
    Scene scene = scene_of(mesh);
    add_plane(scene, {0, 0.2f, 0}, {0, 1, 0});
    add_plane(scene, {0.5f, 0.5f, 0.5f}, glm::normalize(glm::vec3(1, 2, 3)));
    expect_same_hits(scene, 100000, 11);
}

TEST(Hierarchy, finds_the_same_hits_beside_triangles_without_area_and_with_nan) {
    Mesh mesh = random_soup(500, 13, 0.4f);
    Random random(14);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 a = random.in_cube(0, 1), b = random.in_cube(0, 1);
        mesh.add_triangle(a, a, b);
        mesh.add_triangle(a, b, a + 0.5f * (b - a));
        mesh.add_triangle(a, b, glm::vec3(std::numeric_limits<float>::quiet_NaN(), 0, 1));
        mesh.add_triangle(glm::vec3(std::numeric_limits<float>::infinity(), 0, 1), b, a);
    }
    expect_same_hits(scene_of(mesh), 100000, 15);
}

TEST(Hierarchy, finds_the_same_hits_in_a_million_triangles) {
    expect_same_hits(scene_of(uneven_sheet(708)), 500, 16);
}

TEST(Hierarchy, company_does_not_matter_in_random_triangles) {
    expect_company_not_to_matter(scene_of(random_soup(2000, 18)), 18);
}
TEST(Hierarchy, company_does_not_matter_in_a_sheet) {
    expect_company_not_to_matter(scene_of(uneven_sheet(30)), 19);
}
TEST(Hierarchy, company_does_not_matter_in_coincident_sheets) {
    expect_company_not_to_matter(scene_of(coincident_sheets()), 20);
}
TEST(Hierarchy, company_does_not_matter_in_slivers) {
    expect_company_not_to_matter(scene_of(slivers(1000, 21)), 21);
}
TEST(Hierarchy, company_does_not_matter_on_a_closed_mesh_around_the_origin) {
    expect_company_not_to_matter(scene_of(icosphere(4, 1, {0, 0, 0})), 22);
}
TEST(Hierarchy, company_does_not_matter_in_triangles_and_spheres) {
    Mesh mesh = random_soup(800, 23);
    mesh.spheres = random_spheres(800, 24).spheres;
    expect_company_not_to_matter(scene_of(mesh), 23);
}

TEST(Hierarchy, of_coincident_primitives_the_lowest_id_is_hit) {
    Mesh mesh;
    mesh.add_triangle({5, 5, 5}, {6, 5, 5}, {5, 6, 5});  // elsewhere
    for (int copy = 0; copy < 40; ++copy) mesh.add_triangle({-1, -1, 0}, {2, -1, 0.25f}, {-1, 2, 0.5f});
    for (int copy = 0; copy < 40; ++copy) mesh.add_sphere({4, 0, 0}, 1);
    Scene scene = scene_of(mesh);
    for (int copy = 0; copy < 3; ++copy) add_plane(scene, {0, 0, -3}, {0, 0, 1});
    Random random(17);
    std::vector<Ray> rays;
    std::vector<uint> expected;
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 targets[] = {{random.in(-0.9f, 0), random.in(-0.9f, 0), 0},
                                     glm::vec3(4, 0, 0) + 0.5f * random.direction(),
                                     {random.in(-9, -5), random.in(-9, -5), -3}};
        const uint ids[] = {1, 41, 81};
        const glm::vec3 origin(random.in(-0.5f, 0.5f), random.in(-0.5f, 0.5f), 4);
        rays.push_back(make_ray(origin, towards(origin, targets[i % 3])));
        expected.push_back(ids[i % 3]);
    }
    const auto hits = KernelRig(scene).intersect(rays).hits;
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(hits[i].primitive, expected[i]) << i;
}

}  // namespace
}  // namespace raymill::test
