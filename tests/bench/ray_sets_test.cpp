#include "ray_sets.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh_parts.hpp"

namespace raymill::bench {

namespace {

/// A large triangle in the plane z = 0, hit at the origin by a ray from above at 45 degrees, with the lamp above.
std::vector<RaySet> sets_of_one_hit() {
    BenchScene bench;
    bench.lamp = {{0, 0, 2}, 1, {0, 0, -1}};
    add_triangle(bench.scene, {-3, -3, 0}, {3, -3, 0}, {0, 6, 0});
    RaySet camera;
    camera.rays = {{{-1, 0, 1}, INFINITY, glm::normalize(glm::vec3(1, 0, -1))}};
    const CameraHit hit{0, std::sqrt(2.0f), 1.0f / 3, 1.0f / 3};
    return bounced_rays(bench, camera, {&hit, 1});
}

BenchRay only_ray(const std::string& name) {
    for (const RaySet& set : sets_of_one_hit())
        if (set.name == name && set.rays.size() == 1) return set.rays.front();
    ADD_FAILURE() << "no ray in " << name;
    return {};
}

}  // namespace

TEST(RaySets, through_glass_bend_by_snells_law_and_start_inside) {
    const BenchRay ray = only_ray("T");
    EXPECT_LT(ray.origin.z, 0);
    // Rounded once from double.
    EXPECT_NEAR(ray.direction.x, std::sqrt(0.5) / GLASS_INDEX, 1e-7);
    EXPECT_NEAR(ray.direction.y, 0, 1e-7);
    EXPECT_NEAR(ray.direction.z, -std::sqrt(1 - 0.5 / (GLASS_INDEX * GLASS_INDEX)), 1e-7);
}

TEST(RaySets, mirrored_rays_leave_on_the_side_they_came_from) {
    const BenchRay ray = only_ray("R");
    EXPECT_GT(ray.origin.z, 0);
    // As above.
    EXPECT_NEAR(ray.direction.x, std::sqrt(0.5), 1e-7);
    EXPECT_NEAR(ray.direction.z, std::sqrt(0.5), 1e-7);
}

TEST(RaySets, shadow_rays_end_at_the_lamp) {
    const BenchRay ray = only_ray("S");
    EXPECT_GT(ray.origin.z, 0);
    const glm::vec3 end = ray.origin + ray.t_max * ray.direction;
    // Distance and direction are each rounded once.
    EXPECT_NEAR(end.x, 0, 1e-6);
    EXPECT_NEAR(end.y, 0, 1e-6);
    EXPECT_NEAR(end.z, 2, 1e-6);
}

TEST(RaySets, diffuse_rays_leave_on_the_side_they_came_from) {
    const BenchRay ray = only_ray("D");
    EXPECT_GT(ray.origin.z, 0);
    EXPECT_GT(ray.direction.z, 0);
}

}  // namespace raymill::bench
