#include "reference/primitives.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "scene_builder.hpp"

namespace raymill::reference {
namespace {

using Corners = std::array<dvec3, 3>;

const Corners unit_triangle{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0)};

TEST(Triangle, reports_distance_and_weights_of_the_point_it_is_hit_at) {
    for (const dvec3 direction : {dvec3(0, 0, -1), dvec3(0.3, -0.2, -1), dvec3(5, 1, -2)}) {
        const dvec3 target(0.2, 0.5, 0);  // u = x, v = y by construction
        const auto hit = Caster(target - 3.0 * direction, direction).triangle(unit_triangle, Border::closed);
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->t, 3, rounding * 10);  // coordinates up to 15
        EXPECT_NEAR(hit->u, 0.2, rounding * 10);
        EXPECT_NEAR(hit->v, 0.5, rounding * 10);
    }
}

TEST(Triangle, is_hit_from_both_sides_and_behind_the_origin_with_a_negative_distance) {
    EXPECT_EQ(Caster({0.25, 0.25, -2}, {0, 0, 1}).triangle(unit_triangle, Border::closed)->t, 2);
    EXPECT_EQ(Caster({0.25, 0.25, -2}, {0, 0, -1}).triangle(unit_triangle, Border::closed)->t, -2);
}

TEST(Triangle, owns_its_edges_and_vertices_but_nothing_beyond_them) {
    const auto hit = [](double x, double y) {
        return Caster({x, y, 1}, {0, 0, -1}).triangle(unit_triangle, Border::closed).has_value();
    };
    EXPECT_TRUE(hit(0, 0) && hit(1, 0) && hit(0, 1));
    EXPECT_TRUE(hit(0.5, 0) && hit(0, 0.5) && hit(0.5, 0.5));
    EXPECT_FALSE(hit(-1e-15, 0.5) || hit(0.5, -1e-15) || hit(0.5, 0.5 + 1e-15));
}

TEST(Triangle, is_not_hit_edge_on_or_without_area) {
    EXPECT_FALSE(Caster({-1, 0.25, 0}, {1, 0, 0}).triangle(unit_triangle, Border::closed));
    const Corners line{dvec3(-1, 0, 0), dvec3(0), dvec3(2, 0, 0)};
    EXPECT_FALSE(Caster({0, 0, 1}, {0, 0, -1}).triangle(line, Border::closed));
}

TEST(Triangle, scales_by_powers_of_two_to_the_last_bit) {
    const dvec3 origin(0.1, 0.3, 2);
    const dvec3 direction(0.05, -0.03, -1);
    const auto expected = Caster(origin, direction).triangle(unit_triangle, Border::closed);
    ASSERT_TRUE(expected);
    for (const int exponent : {-60, -20, 20, 60}) {
        const double scale = std::ldexp(1, exponent);
        Corners corners = unit_triangle;
        for (dvec3& p : corners) p *= scale;
        const auto hit = Caster(scale * origin, direction).triangle(corners, Border::closed);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->t, scale * expected->t);
        EXPECT_EQ(hit->u, expected->u);
        EXPECT_EQ(hit->v, expected->v);
    }
}

/// How many triangles of a fan around `center` the ray crosses. The rim has `count` vertices on a bumpy circle.
int crossings_of_fan(const dvec3& center, const dvec3& origin, int count) {
    std::vector<dvec3> rim;
    for (int i = 0; i < count; ++i) {
        const double angle = 6.283185307179586 * i / count;
        rim.push_back(center + dvec3(std::cos(angle), std::sin(angle), 0.1 * (i % 3)));
    }
    const Caster caster(origin, center - origin);
    int crossings = 0;
    for (int i = 0; i < count; ++i) {
        const Corners corners{center, rim[i], rim[(i + 1) % count]};
        crossings += caster.triangle(corners, Border::crossing).has_value();
    }
    return crossings;
}

TEST(Triangle, a_shared_vertex_is_crossed_exactly_once) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in(-1, 1);
    for (int i = 0; i < 200; ++i) {
        // The direction is center - origin and may miss the centre by rounding: once is once all the same.
        const dvec3 center(in(random), in(random), in(random));
        EXPECT_EQ(crossings_of_fan(center, center + dvec3(in(random) / 4, in(random) / 4, 3), 3 + i % 6), 1);
    }
    EXPECT_EQ(crossings_of_fan({0, 0, 0}, {0, 0, 2}, 4), 1);  // exactly through it
    EXPECT_EQ(crossings_of_fan({0, 0, 0}, {0, 0, -2}, 8), 1);
}

TEST(Triangle, a_shared_edge_is_crossed_exactly_once) {
    const Corners lower{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(1, 1, 0)};
    const Corners upper{dvec3(0, 0, 0), dvec3(1, 1, 0), dvec3(0, 1, 0)};
    for (const double x : {0.125, 0.5, 0.75}) {
        for (const double z : {-1.0, 1.0}) {
            const Caster caster({x, x, z}, {0, 0, -z});
            ASSERT_TRUE(caster.triangle(lower, Border::closed) && caster.triangle(upper, Border::closed));
            EXPECT_EQ(caster.triangle(lower, Border::crossing).has_value() +
                          caster.triangle(upper, Border::crossing).has_value(),
                      1);
        }
    }
}

TEST(SphereHit, is_a_chord_from_outside_and_surrounds_the_origin_from_inside) {
    const auto outside = Caster({0, 0.6, 5}, {0, 0, -2}).sphere(dvec3(0), 1);
    ASSERT_TRUE(outside);
    EXPECT_NEAR(outside->near, (5 - 0.8) / 2, rounding);  // half chord sqrt(1 - 0.6^2), direction of length 2
    EXPECT_NEAR(outside->far, (5 + 0.8) / 2, rounding);
    const auto inside = Caster({0, 0.6, 0.1}, {0, 0, -1}).sphere(dvec3(0), 1);
    ASSERT_TRUE(inside);
    EXPECT_NEAR(inside->near, -0.7, rounding);
    EXPECT_NEAR(inside->far, 0.9, rounding);
}

TEST(SphereHit, a_tangent_touches_once_and_beyond_it_nothing) {
    const auto tangent = Caster({0, 1, 5}, {0, 0, -1}).sphere(dvec3(0), 1);
    ASSERT_TRUE(tangent);
    EXPECT_NEAR(tangent->near, 5, rounding);
    EXPECT_NEAR(tangent->far, 5, rounding);
    EXPECT_FALSE(Caster({0, 1 + 1e-15, 5}, {0, 0, -1}).sphere(dvec3(0), 1));
}

TEST(SphereHit, stays_accurate_for_tiny_distant_and_for_huge_spheres) {
    // A centimetre a thousand kilometres away: b^2 - ac would lose the radius entirely.
    const auto tiny = Caster({0, 0, 1e6}, {0, 0, -1}).sphere(dvec3(0), 1e-5);
    ASSERT_TRUE(tiny);
    EXPECT_NEAR(tiny->far - tiny->near, 2e-5, 5e-10);  // t itself is rounded to 1e6 * 2^-53 a few times
    const auto huge = Caster({0, 2, 0}, {0, -1, 0}).sphere({0, -1e9, 0}, 1e9);
    ASSERT_TRUE(huge);
    EXPECT_NEAR(huge->near, 2, 1e-6);  // the radius is rounded to 1e9 * 2^-53
}

TEST(PlaneHit, is_at_the_distance_along_the_normal_over_the_slope) {
    EXPECT_NEAR(*Caster({1, 2, 3}, {3, -4, 0}).plane({0, 1, 0}, {0, 1, 0}), 0.25, rounding);  // 1 / 4
    EXPECT_FALSE(Caster({1, 2, 3}, {1, 0, 0}).plane({0, 1, 0}, {0, 1, 0}));
}

TEST(Intersect, chooses_the_closest_and_of_equals_the_lowest_id) {
    SceneBuilder b;
    b.add_plane({0, 0, -1}, {0, 0, 1});
    b.add_sphere({0, 0, 0}, 1);
    b.add_sphere({0, 0, 0}, 1);
    b.add_triangle({glm::vec3(-1, -1, 1), glm::vec3(1, -1, 1), glm::vec3(0, 2, 1)});
    const Tracer tracer(b.scene);
    const Ray ray{{0, 0, 5}, {0, 0, -1}};
    EXPECT_EQ(tracer.intersect(ray).primitive, 0u);  // triangle and spheres at 4: triangles come first
    EXPECT_EQ(tracer.intersect({{0, 0, 0.5}, {0, 0, -1}}).primitive, 1u);
    EXPECT_EQ(tracer.intersect({{0, 2, 0.5}, {0, 0, -1}}).primitive, 3u);
    EXPECT_EQ(tracer.intersect(ray, 4).t, 6);  // t must exceed t_min: the far side of the spheres
    EXPECT_EQ(tracer.intersect({{0, 3, 0.5}, {0, 0, 1}}).primitive, NO_INDEX);
    EXPECT_EQ(tracer.intersect_primitive(ray, 3).t, 6);
    EXPECT_EQ(tracer.intersect_primitive(ray, 2).t, 4);
}

TEST(Intersect, never_hits_a_triangle_without_area_or_with_a_vertex_that_is_not_finite) {
    SceneBuilder b;
    b.add_triangle({glm::vec3(-1, 0, 0), glm::vec3(0.3f, 0, 0), glm::vec3(1, 0, 0)});
    b.add_triangle({glm::vec3(-1, -1, 0), glm::vec3(1, -1, 0), glm::vec3(0, NAN, 0)});
    const Tracer tracer(b.scene);
    EXPECT_EQ(tracer.intersect({{0, 0, 1}, {0, 0, -1}}).primitive, NO_INDEX);
    EXPECT_EQ(tracer.intersect({{0.1, 0.2, 1}, {0, -0.2, -1}}).primitive, NO_INDEX);
}

TEST(Surface, interpolates_normals_and_uv_by_the_hits_weights) {
    SceneBuilder b;
    b.add_triangle({glm::vec3(0, 0, 2), glm::vec3(1, 0, 2), glm::vec3(0, 1, 2)}, 0,
                   {glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)},
                   {glm::vec2(0, 0), glm::vec2(2, 0), glm::vec2(0, 4)});
    const Tracer tracer(b.scene);
    const Ray ray{{0.25, 0.5, 5}, {0, 0, -1}};
    const Surface s = tracer.surface(ray, tracer.intersect(ray));
    EXPECT_EQ(s.position, dvec3(0.25, 0.5, 2));
    EXPECT_EQ(s.geometric_normal, dvec3(0, 0, 1));
    expect_near(s.shading_normal, glm::normalize(dvec3(0.25, 0.5, 0.25)), rounding);
    EXPECT_EQ(s.uv, dvec2(0.5, 2));
    EXPECT_FALSE(s.inside);
    const Ray behind{{0.25, 0.5, -5}, {0, 0, 1}};
    EXPECT_TRUE(tracer.surface(behind, tracer.intersect(behind)).inside);
}

TEST(Surface, is_flat_where_the_material_or_a_vertex_says_so_or_the_normals_cancel) {
    const std::array<glm::vec3, 3> points{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
    const glm::vec3 x(1, 0, 0);
    SceneMaterial flat;
    flat.shading = Shading::flat;
    SceneBuilder b;
    b.add_triangle(points, b.add_material(flat), {x, x, x});
    b.add_triangle(points, 0, {x, x, glm::vec3(0)});
    b.add_triangle(points, 0, {glm::vec3(0, 0, 1), x, -x});
    const Tracer tracer(b.scene);
    const Ray ray{{0.5, 0.5, 1}, {0, 0, -1}};  // u = v = 1/2: of the third, x - x
    for (std::uint32_t id = 0; id < 3; ++id) {
        const Surface s = tracer.surface(ray, tracer.intersect_primitive(ray, id));
        EXPECT_EQ(s.shading_normal, dvec3(0, 0, 1)) << "triangle " << id;
    }
}

TEST(Spawn, a_ray_does_not_meet_the_surface_it_starts_on_at_any_scale_or_place) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> in(-1, 1);
    for (const float scale : {1e-6f, 1.0f, 1e6f}) {
        for (const float place : {0.0f, 1e3f}) {
            const glm::vec3 center = glm::vec3(place, -place, 2 * place) * scale;
            SceneBuilder b;
            b.add_sphere(center, scale);
            const Tracer tracer(b.scene);
            for (int i = 0; i < 200; ++i) {
                const dvec3 target = dvec3(center) + 0.99 * scale * glm::normalize(dvec3(in(random), in(random), 1));
                const dvec3 origin = dvec3(center) + dvec3(0, 0, 5.0 * scale);
                const Ray ray{origin, glm::normalize(target - origin)};
                const Hit hit = tracer.intersect(ray);
                ASSERT_EQ(hit.primitive, 0u);
                const Surface s = tracer.surface(ray, hit);
                const dvec3 n = s.geometric_normal;
                const dvec3 grazing = glm::normalize(glm::cross(n, dvec3(1, 0, 0)) + 1e-9 * n);
                EXPECT_EQ(tracer.intersect(tracer.spawn(ray, hit, s, grazing)).primitive, NO_INDEX);
                // Inwards it meets the far side: the chord at 60 degrees to the normal is one radius long.
                // 1e-9: the centre's coordinates exceed the radius by 2e3 and are rounded by 2^-53 of that.
                const dvec3 inward = glm::normalize(std::sqrt(3.0) * glm::normalize(glm::cross(n, dvec3(1, 0, 0))) - n);
                EXPECT_NEAR(tracer.intersect(tracer.spawn(ray, hit, s, inward)).t / scale, 1, 1e-9);
            }
        }
    }
}

TEST(Spawn, a_ray_that_barely_leaves_a_tilted_triangle_or_plane_does_not_meet_it_again) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> in(-1, 1);
    const auto point = [&] { return glm::vec3(in(random), in(random), in(random)); };
    for (int i = 0; i < 500; ++i) {
        SceneBuilder b;
        const glm::vec3 corner = point(), second = point(), third = point();
        if (i % 2 == 0) {
            b.add_triangle({corner, second, third});
        } else {
            b.add_plane(corner, glm::normalize(glm::cross(second - corner, third - corner)));
        }
        const Tracer tracer(b.scene);
        const dvec3 origin = 4.0 * dvec3(point());
        const Ray ray{origin, dvec3(corner + second + third) / 3.0 - origin};
        const Hit hit = tracer.intersect(ray);
        ASSERT_NE(hit.primitive, NO_INDEX);
        const Surface s = tracer.surface(ray, hit);
        const dvec3 n = s.geometric_normal;
        for (const double lift : {1e-12, -1e-12, 1e-9}) {
            const dvec3 direction = glm::normalize(glm::cross(n, dvec3(point())) + lift * n);
            EXPECT_EQ(tracer.intersect(tracer.spawn(ray, hit, s, direction)).primitive, NO_INDEX);
        }
    }
}

TEST(Spawn, a_ray_through_a_shared_edge_goes_on_without_meeting_the_neighbour) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> in(-1, 1);
    const auto point = [&] { return glm::vec3(in(random), in(random), in(random)); };
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
        SceneBuilder b;
        const glm::vec3 a = point(), c = point(), side = point();
        b.add_quad(a, (a + c) / 2.0f + side, c, (a + c) / 2.0f - side);
        const Tracer tracer(b.scene);
        const dvec3 origin = 4.0 * dvec3(point());
        const dvec3 on_edge = glm::mix(dvec3(a), dvec3(c), 0.1 + 0.002 * (i % 400));
        const Ray ray{origin, glm::normalize(on_edge - origin)};
        const Hit hit = tracer.intersect(ray);
        if (hit.primitive == NO_INDEX) continue;  // rounding may pass an edge of a folded pair on its outside
        ++hits;
        const Ray next = tracer.spawn(ray, hit, tracer.surface(ray, hit), ray.direction);
        EXPECT_EQ(tracer.intersect(next).primitive, NO_INDEX);
    }
    EXPECT_GT(hits, 400);
}

}  // namespace
}  // namespace raymill::reference
