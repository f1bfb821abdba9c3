// What each light gives to a point: attenuation, direction, cones, and the form factors of lights with an area.
#include <array>
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

constexpr double pi = glm::pi<double>();

/// A white floor y = 0, its camera above the point that is looked at.
SceneBuilder white_floor() {
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(white()));
    return b;
}
dvec3 above(const dvec3& point) {
    return point + dvec3(0.25, 1, 0.125);
}

TEST(Attenuation, is_one_over_the_polynomial_of_the_distance_for_each_coefficient_and_obliquely) {
    const std::array<glm::vec3, 5> coefficients = {glm::vec3(1, 0, 0), glm::vec3(2, 0, 0), glm::vec3(0, 1, 0),
                                                   glm::vec3(0, 0, 1), glm::vec3(0.25f, 0.5f, 0.125f)};
    for (const glm::vec3& c : coefficients) {
        PointLight light = point_light({0, 0.5, 0}, 3);
        light.attenuation = c;
        SceneBuilder b = white_floor();
        b.add_light(light);
        Probe probe(b.scene);
        for (const double x : {0.0, 0.25, 1.0, 4.0}) {
            SCOPED_TRACE(testing::Message() << c.x << ' ' << c.y << ' ' << c.z << ", x = " << x);
            const dvec3 point(x, 0, 0);
            const double d = std::hypot(x, 0.5);
            // I = I_0 cos(theta) / (c0 + c1 d + c2 d^2), not clamped below one unit; cos(theta) = h / d.
            const double expected = 3 * (0.5 / d) / (c.x + c.y * d + c.z * d * d);
            // Of the terms the cube of the distance is the steepest: three times the hit point's error over the
            // distance.
            const double bound = expected * hit_roundings * (1 + 3 * (x + 1) / d);
            expect_seen(probe, above(point), point, dvec3(expected), bound);
        }
    }
}

TEST(Attenuation, reaches_the_kernels_from_a_scene_file) {
    Probe probe(scene_of(R"(
        [render]
        size = [1, 1]
        [[light]]
        type = "point"
        position = [0, 2, 0]
        intensity = [8, 4, 2]
        attenuation = [1, 0.5, 0.5]
        [[object]]
        shape = "plane"
        point = [0, 0, 0]
        normal = [0, 1, 0]
    )"));
    // 0.8 / (1 + 0.5 * 2 + 0.5 * 4) = 0.2 of the intensity: the default k_d, straight below.
    expect_seen(probe, above({}), {}, dvec3(1.6, 0.8, 0.4), 1.6 * hit_roundings);
}

TEST(Directional, is_the_limit_of_a_point_light_that_moves_away_and_brightens) {
    const dvec3 to_light = glm::normalize(dvec3(1, 2, 0.5));
    const dvec3 point(0.5, 0, -0.25);
    SceneBuilder b = white_floor();
    b.add_light(directional_light(-to_light));
    const double limit = look(b.scene, above(point), point).x;
    EXPECT_NEAR(limit, to_light.y, hit_roundings);
    for (const double distance : {1e2, 1e3, 1e4, 1e6}) {
        PointLight light = point_light(distance * to_light, distance * distance);
        light.attenuation = {0, 0, 1};
        SceneBuilder near = white_floor();
        near.add_light(light);
        const double seen = look(near.scene, above(point), point).x;
        // (D / d)^2 cos' with d and the direction off by at most |p| / D: together 3 |p| / D, to first order.
        EXPECT_NEAR(seen, limit, 3.1 * glm::length(point) / distance + hit_roundings);
        if (distance == 1e2) {
            EXPECT_GT(std::abs(seen - limit), 1e-4);  // near by it is another light
        }
    }
}

TEST(Directional, lights_alike_to_the_last_bit_at_any_distance) {
    const auto seen_at_height = [](float height) {
        SceneMaterial material;
        material.specular = glm::vec3(0.5f);
        SceneBuilder b;
        b.add_plane({0, height, 0}, {0, 1, 0}, b.add_material(material));
        DirectionalLight light;
        light.direction = {0.3f, -1, 0.2f};
        light.intensity = {1, 2, 3};
        b.add_light(light);
        // A power of two away, so that the direction from the eye is the same float.
        return look(b.scene, {1, height + 2, 0.5}, {0, height, 0});
    };
    const dvec3 near = seen_at_height(0);
    EXPECT_GT(near.x, 0.5);
    for (const float height : {1.0f, -1024.0f, 65536.0f}) EXPECT_EQ(seen_at_height(height), near);
}

TEST(Spot, falls_from_the_inner_to_the_outer_angle_as_gltf_says) {
    SceneBuilder b = white_floor();
    SpotLight light;
    light.position = {0, 4, 0};
    light.inner_angle = 20;
    light.outer_angle = 40;
    b.add_light(light);
    Probe probe(b.scene);
    const double inner = std::cos(degrees(20)), outer = std::cos(degrees(40));
    for (const double angle : {0.0, 10.0, 19.9, 20.1, 25.0, 30.0, 35.0, 39.9, 40.1, 60.0}) {
        SCOPED_TRACE(angle);
        // KHR_lights_punctual: saturate((cos - cos_outer) / (cos_inner - cos_outer))^2; the floor adds cos(theta).
        const double cone = std::clamp((std::cos(degrees(angle)) - outer) / (inner - outer), 0.0, 1.0);
        const dvec3 point(4 * std::tan(degrees(angle)), 0, 0);
        // The cosine's error grows by the slope of the square: 2 / (cos_inner - cos_outer) = 11.5.
        expect_seen(probe, above(point), point, dvec3(cone * cone * std::cos(degrees(angle))), 12.5 * hit_roundings);
    }
}

TEST(Spot, with_equal_angles_has_a_hard_edge) {
    SceneBuilder b = white_floor();
    SpotLight light;
    light.position = {0, 4, 0};
    light.inner_angle = light.outer_angle = 30;
    b.add_light(light);
    Probe probe(b.scene);
    const auto at = [&](double angle) {
        const dvec3 point(4 * std::tan(degrees(angle)), 0, 0);
        return probe.look(above(point), point).x;
    };
    // The specification divides by at least 0.001: full light 0.12 degrees inside, none outside.
    EXPECT_NEAR(at(29.8), std::cos(degrees(29.8)), hit_roundings);
    EXPECT_EQ(at(30.1), 0);
}

/// Form factor of a rectangle parallel to the element, seen from below its corner: sides x and z at height h; odd in
/// both. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3.
double corner_form_factor(double x, double z, double h) {
    const double a = x / h, b = z / h, ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * pi);
}

/// Same for any place: the rectangle [x0, x1] x [z0, z1] relative to the element's foot.
double rectangle_form_factor(double x0, double x1, double z0, double z1, double h) {
    return corner_form_factor(x1, z1, h) - corner_form_factor(x0, z1, h) - corner_form_factor(x1, z0, h) +
           corner_form_factor(x0, z0, h);
}

RectangleLight ceiling_lamp() {
    RectangleLight light;  // [-1, 1] x [-0.5, 0.5] at height 2, shining down: u x v = -y
    light.center = {0, 2, 0};
    light.edge_u = {2, 0, 0};
    light.edge_v = {0, 0, 1};
    light.radiance = glm::vec3(3);
    return light;
}

TEST(RectangleLight, answers_its_radiance_times_the_form_factor) {
    SceneBuilder b = white_floor();
    b.add_light(ceiling_lamp(), 16);
    Probe probe(b.scene);
    for (const dvec3 point : {dvec3(0, 0, 0), dvec3(0.75, 0, 0.25), dvec3(-2.5, 0, 1)}) {
        SCOPED_TRACE(point.x);
        const double f = rectangle_form_factor(-1 - point.x, 1 - point.x, -0.5 - point.z, 0.5 - point.z, 2);
        expect_estimate(estimate(probe, above(point), point), 3 * f);  // k_d F L
    }
}

TEST(RectangleLight, is_dark_behind) {
    SceneBuilder b = white_floor();
    RectangleLight light = ceiling_lamp();
    std::swap(light.edge_u, light.edge_v);
    b.add_light(light, 16);
    EXPECT_EQ(look(b.scene, above({}), {}), dvec3(0));
}

TEST(DiskLight, answers_its_radiance_times_the_form_factor) {
    SceneBuilder b = white_floor();
    DiskLight light;
    light.center = {0, 2, 0};
    light.radius = 1.5f;
    light.radiance = glm::vec3(2);
    b.add_light(light, 16);
    Probe probe(b.scene);
    for (const double a : {0.0, 1.0, 4.0}) {
        SCOPED_TRACE(a);
        // Howell B-13 with distances not divided by the offset: F = (1 - (h^2 + a^2 - r^2) / sqrt((h^2+a^2+r^2)^2 -
        // 4 a^2 r^2)) / 2; on the axis r^2 / (h^2 + r^2).
        const double h2 = 4, a2 = a * a, r2 = 2.25, z = h2 + a2 + r2;
        const double f = 0.5 * (1 - (h2 + a2 - r2) / std::sqrt(z * z - 4 * a2 * r2));
        const dvec3 point(0, 0, a);
        expect_estimate(estimate(probe, above(point), point), 2 * f);
    }
}

TEST(SphereLight, answers_its_radiance_times_the_form_factor) {
    SceneBuilder b = white_floor();
    SphereLight light;
    light.center = {0, 2, 0};
    light.radius = 0.75f;
    light.radiance = glm::vec3(5);
    b.add_light(light, 16);
    Probe probe(b.scene);
    for (const double x : {0.0, 1.0, 3.0}) {
        SCOPED_TRACE(x);
        // Wholly above the horizon: F = (r / d)^2 cos(theta); Nusselt's analog, Howell B-43.
        const double d = std::hypot(x, 2.0);
        const dvec3 point(x, 0, 0);
        expect_estimate(estimate(probe, above(point), point), 5 * 0.5625 / (d * d) * (2 / d));
    }
}

TEST(Penumbra, behind_a_half_plane_shows_the_form_factor_of_what_is_left_of_the_lamp) {
    SceneBuilder b = white_floor();
    b.add_light(ceiling_lamp(), 64);
    // Covers x > 0.25 at height 1, wide enough to hide whatever lies beyond its edge.
    b.add_quad({0.25f, 1, -9}, {9, 1, -9}, {9, 1, 9}, {0.25f, 1, 9});
    Probe probe(b.scene);
    for (const double x : {0.0, 0.25, 0.5}) {
        SCOPED_TRACE(x);
        // By similar triangles the edge hides the lamp from x + (0.25 - x) 2 / 1 on.
        const double edge = x + (0.25 - x) * 2;
        const double f = rectangle_form_factor(-1 - x, edge - x, -0.5, 0.5, 2);
        const dvec3 point(x, 0, 0);
        expect_estimate(estimate(probe, {x - 1, 0.5, 0}, point), 3 * f);
    }
    for (const double x : {1.75, -1.0}) {  // umbra: beyond 1.5; full light: before -0.5
        const dvec3 point(x, 0, 0);
        const Estimate e = estimate(probe, {x - 1, 0.5, 0}, point);
        if (x > 0)
            EXPECT_EQ(e.mean.x, 0);
        else
            expect_estimate(e, 3 * rectangle_form_factor(-1 - x, 1 - x, -0.5, 0.5, 2));
    }
}

TEST(BallLight, casts_the_penumbra_of_its_projected_area) {
    SceneBuilder b = white_floor();
    PointLight light = point_light({0, 200, 0});
    light.radius = 10;
    b.add_light(light, 64);
    b.add_quad({0, 100, -99}, {99, 100, -99}, {99, 100, 99}, {0, 100, 99});
    Probe probe(b.scene);
    for (const double x : {-4.0, 0.0, 5.0}) {
        SCOPED_TRACE(x);
        // The plane through the point and the edge cuts off a cap of the sphere; a uniform sample of a sphere lies
        // beyond a plane at distance q of its centre with probability (1 - q / r) / 2, Archimedes.
        const double q = -x / std::hypot(1.0, x / 100);  // at height 200 the plane is at -x
        const double lit = 0.5 * (1 + q / 10);
        // The cosine of a sample at (dx, dy) is 1 - O((dx + x)^2 / 200^2) / 2: at most 15^2 / 80000 from 1.
        const dvec3 point(x, 0, 0);
        const Estimate e = estimate(probe, {x - 1, 0.5, 0}, point);
        EXPECT_NEAR(e.mean.x, lit, 4 * e.error.x + 15.0 * 15.0 / 80000);
        EXPECT_LT(e.error.x, 0.02 * lit);
    }
}

}  // namespace
}  // namespace raymill::truths
