// The closest hit against the reference's, ray by ray: which primitive, where, and with which weights.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "kernel_rig.hpp"
#include "queues.hpp"
#include "random.hpp"

namespace raymill::test {
namespace {

using glm::dvec3;

/// How far the kernel's arithmetic may be from the exact hit of this ray with this primitive.
struct HitError {
    double t = 0, weight = 0;
};

double largest(const dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Woop's test: the vertices relative to the ray, sheared, have 5 roundings; the edge functions are differences of
/// their products; the weights are quotients of those, and t the mean of the vertices' distances that they weigh.
HitError triangle_error(const Scene& scene, const reference::Ray& ray, uint id) {
    dvec3 p[3];
    for (int k = 0; k < 3; ++k)
        p[k] = reference::to_dvec3(scene.vertices[scene.triangles[id].vertex[k]].position) - ray.origin;
    const dvec3 d = ray.direction;
    const double along = largest(d);  // of the axis that the ray follows
    const dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double det = std::abs(glm::dot(normal, d)) / along;
    const double reach = std::max({largest(p[0]), largest(p[1]), largest(p[2])});
    double across = 0;  // largest distance of a vertex from the ray
    for (const dvec3& q : p) across = std::max(across, glm::length(glm::cross(q, d)) / along);
    const double edge_error = 4 * across * (5 * ROUNDING * 2 * reach) + 3 * ROUNDING * across * across;
    const double weight_error = 4 * edge_error / det + 4 * ROUNDING;
    return {(6 * reach * weight_error + 8 * ROUNDING * reach) / along, weight_error};
}

/// b = -f.d and c = f.f - r^2 have 4 roundings of |f| and of |f|^2 + r^2, the discriminant as many of twice its terms;
/// the root loses what is near zero, and the first end of the chord is a quotient by b + root.
HitError sphere_error(const Sphere& sphere, const reference::Ray& ray, double t) {
    const dvec3 f = ray.origin - reference::to_dvec3(sphere.center);
    const double size = glm::length(f) + sphere.radius, r2 = double{sphere.radius} * sphere.radius;
    const double b = -glm::dot(f, ray.direction);
    const dvec3 p = f + b * ray.direction;
    const double discriminant = std::max(r2 - glm::dot(p, p), 0.0);
    const double discriminant_error = 8 * ROUNDING * (r2 + sphere.radius * size);
    const double root_error = discriminant_error / std::max(std::sqrt(discriminant), std::sqrt(discriminant_error));
    const double q = std::abs(b) + std::sqrt(discriminant), q_error = 6 * ROUNDING * size + root_error;
    return {q_error + (8 * ROUNDING * size * size + t * q_error) / q + 4 * ROUNDING * t, 0};
}

HitError plane_error(const Plane& plane, const reference::Ray& ray, double t) {
    const double slope = std::abs(glm::dot(reference::to_dvec3(plane.normal), ray.direction));
    const double away = glm::length(ray.origin - reference::to_dvec3(plane.point));
    return {(5 * ROUNDING * away + 4 * ROUNDING * t) / slope + 2 * ROUNDING * t, 0};
}

HitError hit_error(const Scene& scene, const reference::Ray& ray, uint primitive, double t) {
    if (primitive < scene.triangles.size()) return triangle_error(scene, ray, primitive);
    const std::size_t i = primitive - scene.triangles.size();
    if (i < scene.spheres.size()) return sphere_error(scene.spheres[i], ray, t);
    return plane_error(scene.planes[i - scene.spheres.size()], ray, t);
}

/// Whether a ray within rounding of this one meets that primitive first: its origin moved by 16 roundings of the
/// largest coordinate across it, as shear and translation may. A hit as near as its error to the first one counts as
/// well.
bool may_be_met(const Scene& scene, const reference::Tracer& tracer, const reference::Ray& ray, uint primitive,
                double t) {
    const dvec3 across =
        glm::normalize(glm::cross(ray.direction, std::abs(ray.direction.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
    const dvec3 other = glm::cross(ray.direction, across);
    const double step = 16 * ROUNDING * (largest(ray.origin) + (t < 1e6 ? t : 10));
    for (int i = 0; i <= 16; ++i) {
        const double angle = i * 0.3926990816987;
        reference::Ray moved = ray;
        if (i > 0) moved.origin += step * (std::cos(angle) * across + std::sin(angle) * other);
        const reference::Hit first = tracer.intersect(moved);
        if (first.primitive == primitive) return true;
        if (primitive == NO_INDEX || first.primitive == NO_INDEX) continue;
        const reference::Hit that = tracer.intersect_primitive(moved, primitive);
        const double slack =
            hit_error(scene, moved, primitive, that.t).t + hit_error(scene, moved, first.primitive, first.t).t;
        if (that.t - first.t <= slack) return true;
    }
    return false;
}

std::vector<Ray> random_rays(const Scene& scene, std::size_t count, std::uint32_t seed) {
    Random random(seed);
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres);
    const bool bounded = bvh.bounds.lower.x <= bvh.bounds.upper.x;
    const glm::vec3 center = bounded ? 0.5f * (bvh.bounds.lower + bvh.bounds.upper) : glm::vec3(0);
    const glm::vec3 half = bounded ? 0.5f * (bvh.bounds.upper - bvh.bounds.lower) : glm::vec3(1);
    std::vector<Ray> rays;
    for (uint i = 0; i < count; ++i) {
        const glm::vec3 origin = center + random.in(0, 3) * half * random.direction();
        rays.push_back(make_ray(origin, towards(origin, center + half * random.in_cube(-1, 1)), i));
    }
    return rays;
}

/// Compares all; at most `share` of the rays may be decided by rounding.
void expect_reference_hits(const Scene& scene, std::size_t count, std::uint32_t seed, double share) {
    const std::vector<Ray> rays = random_rays(scene, count, seed);
    const auto hits = KernelRig(scene).intersect(rays).hits;
    const reference::Tracer tracer(scene);
    std::size_t decided_by_rounding = 0, hit = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "ray " << i);
        const reference::Ray ray = exact(rays[i]);
        const reference::Hit expected = tracer.intersect(ray);
        hit += expected.primitive != NO_INDEX;
        if (hits[i].primitive != expected.primitive) {
            ++decided_by_rounding;
            ASSERT_TRUE(may_be_met(scene, tracer, ray, hits[i].primitive, expected.t))
                << hits[i].primitive << " at " << hits[i].t << ", not " << expected.primitive << " at " << expected.t;
            continue;
        }
        if (expected.primitive == NO_INDEX) {
            ASSERT_EQ(hits[i].t, INFINITY);
            continue;
        }
        const HitError error = hit_error(scene, ray, expected.primitive, expected.t);
        ASSERT_NEAR(hits[i].t, expected.t, error.t) << "primitive " << expected.primitive;
        ASSERT_NEAR(hits[i].u, expected.u, error.weight) << "primitive " << expected.primitive;
        ASSERT_NEAR(hits[i].v, expected.v, error.weight) << "primitive " << expected.primitive;
    }
    EXPECT_LE(static_cast<double>(decided_by_rounding), share * static_cast<double>(count));
    EXPECT_GT(hit, count / 10);
}

Mesh scaled(Mesh mesh, float factor) {
    for (Vertex& vertex : mesh.vertices) store(vertex.position, vec3_of(vertex.position) * factor);
    for (Sphere& sphere : mesh.spheres) {
        store(sphere.center, vec3_of(sphere.center) * factor);
        sphere.radius *= factor;
    }
    return mesh;
}

// A ray within 16 roundings of an edge, of some ten edges that it passes: less than one in 1e4.
constexpr double RARE = 5e-4;

TEST(Intersect, random_triangles_are_hit_like_the_reference_s) {
    expect_reference_hits(scene_of(random_soup(600, 31, 0.2f)), 15000, 31, RARE);
}
TEST(Intersect, tiny_triangles_are_hit_like_the_reference_s) {
    expect_reference_hits(scene_of(scaled(random_soup(600, 32, 0.2f), 1e-4f)), 8000, 32, RARE);
}
TEST(Intersect, huge_triangles_are_hit_like_the_reference_s) {
    expect_reference_hits(scene_of(scaled(random_soup(600, 33, 0.2f), 1e5f)), 8000, 33, RARE);
}
TEST(Intersect, triangles_of_very_different_size_are_hit_like_the_reference_s) {
    Mesh mesh = random_soup(300, 34, 0.02f);
    for (const Mesh& larger : {random_soup(20, 35, 2), random_soup(5, 36, 30)})
        for (const Triangle& t : larger.triangles)
            mesh.add_triangle(vec3_of(larger.vertices[t.vertex[0]].position),
                              vec3_of(larger.vertices[t.vertex[1]].position),
                              vec3_of(larger.vertices[t.vertex[2]].position));
    expect_reference_hits(scene_of(mesh), 10000, 34, RARE);
}
TEST(Intersect, closed_meshes_are_hit_like_the_reference_s) {
    expect_reference_hits(scene_of(icosphere(2, 1, {0.3f, -0.2f, 5})), 10000, 37, RARE);
}
TEST(Intersect, slivers_are_hit_like_the_reference_s) {
    // A sliver is as wide as ten roundings of its coordinates: rays that come near one may go either way.
    Mesh mesh = slivers(300, 38);
    for (const Triangle& t : random_soup(50, 39, 0.4f).triangles) {
        const Mesh soup = random_soup(50, 39, 0.4f);
        mesh.add_triangle(vec3_of(soup.vertices[t.vertex[0]].position), vec3_of(soup.vertices[t.vertex[1]].position),
                          vec3_of(soup.vertices[t.vertex[2]].position));
    }
    expect_reference_hits(scene_of(mesh), 10000, 38, 1e-2);
}
TEST(Intersect, spheres_are_hit_like_the_reference_s) {
    expect_reference_hits(scene_of(random_spheres(600, 40)), 15000, 40, RARE);
}
TEST(Intersect, huge_spheres_are_hit_like_the_reference_s) {
    expect_reference_hits(scene_of(scaled(random_spheres(600, 41), 1e4f)), 8000, 41, RARE);
}
TEST(Intersect, planes_are_hit_like_the_reference_s) {
    Scene scene;
    scene.materials.emplace_back();
    Random random(42);
    for (int i = 0; i < 20; ++i) add_plane(scene, random.in_cube(-1, 1), random.direction());
    expect_reference_hits(scene, 15000, 42, RARE);
}
TEST(Intersect, mixed_primitives_are_hit_like_the_reference_s) {
    Mesh mesh = random_soup(300, 43, 0.3f);
    mesh.spheres = random_spheres(200, 44).spheres;
    Scene scene = scene_of(mesh);
    add_plane(scene, {0.5f, 0.1f, 0.5f}, {0, 1, 0});
    add_plane(scene, {0.5f, 0.5f, 0.9f}, glm::normalize(glm::vec3(-1, 2, -3)));
    expect_reference_hits(scene, 15000, 43, RARE);
}

TEST(IntersectQueue, any_size_and_first_ray_give_the_same_hits_and_touch_nothing_else) {
    Mesh mesh = random_soup(200, 45, 0.4f);
    mesh.spheres = random_spheres(100, 46).spheres;
    const Scene scene = scene_of(mesh);
    const std::vector<Ray> rays = random_rays(scene, 500, 45);
    const KernelRig rig(scene);
    const auto whole = rig.intersect(rays).hits;
    for (const std::size_t size : {0u, 1u, 63u, 64u, 65u, 500u}) {
        const auto hits = rig.intersect(std::span(rays).first(size)).hits;
        for (std::size_t i = 0; i < size; ++i) ASSERT_TRUE(same_bits(hits[i], whole[i])) << size;
        EXPECT_EQ(touched_from(hits, size), 0u);
    }
    const auto later = rig.intersect(rays, 77).hits;
    for (std::size_t i = 0; i < 500 - 77; ++i) ASSERT_TRUE(same_bits(later[i], whole[77 + i]));
    EXPECT_EQ(touched_from(later, 500 - 77), 0u);
}

TEST(IntersectCorners, a_ray_along_a_plane_never_meets_it_from_either_side) {
    Scene scene;
    scene.materials.emplace_back();
    add_plane(scene, {0, 1, 0}, {0, 1, 0});
    std::vector<Ray> rays;
    for (const float height : {0.0f, 1.0f, 2.0f})
        for (const float x : {1.0f, -1.0f})
            for (const float y : {0.0f, -0.0f}) rays.push_back(make_ray({0, height, 0}, {x, y, 0}));
    for (const Hit& hit : KernelRig(scene).intersect(rays).hits)
        if (!is_untouched(hit)) {
            EXPECT_EQ(hit.primitive, NO_INDEX);
        }
}

TEST(IntersectCorners, what_lies_behind_the_origin_is_not_met) {
    Mesh mesh;
    mesh.add_triangle({-9, -9, 1}, {9, -9, 1}, {0, 9, 1});
    mesh.add_sphere({0, 0, 3}, 1);
    Scene scene = scene_of(mesh);
    add_plane(scene, {0, 0, 5}, {0, 0, 1});
    const std::vector<Ray> rays = {make_ray({0, 0, 0}, {0, 0, 1}), make_ray({0, 0, 1.5f}, {0, 0, 1}),
                                   make_ray({0, 0, 3}, {0, 0, 1}), make_ray({0, 0, 4.5f}, {0, 0, 1}),
                                   make_ray({0, 0, 6}, {0, 0, 1})};
    const auto hits = KernelRig(scene).intersect(rays).hits;
    const uint ids[] = {0, 1, 1, 2, NO_INDEX};
    const float distances[] = {1, 0.5f, 1, 0.5f, INFINITY};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(hits[i].primitive, ids[i]) << i;
        EXPECT_EQ(hits[i].t, distances[i]) << i;  // small integers and halves: no rounding
    }
}

TEST(IntersectCorners, the_weights_are_those_of_vertices_one_and_two) {
    Mesh mesh;
    mesh.add_triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
    const std::vector<Ray> rays = {make_ray({1, 0.5f, 1}, {0, 0, -1})};
    const Hit hit = KernelRig(scene_of(mesh)).intersect(rays).hits.front();
    EXPECT_EQ(hit.u, 0.25f);
    EXPECT_EQ(hit.v, 0.125f);
}

}  // namespace
}  // namespace raymill::test
