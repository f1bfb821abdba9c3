// How much is refracted and reflected: the critical angle, Fresnel's formulas, absorption.
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

/// Water below y = 0 with a black bottom, under a bright sky.
Scene pool(bool fresnel) {
    SceneBuilder b;
    SceneMaterial water = clear(1.33);
    water.fresnel = fresnel;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(water));
    b.add_plane({0, -5, 0}, {0, 1, 0}, b.add_material(black()));
    b.scene.settings.background = dvec3(1);
    return b.scene;
}

/// From two units deep, at this angle to the vertical.
dvec3 seen_from_below(Probe& probe, double angle) {
    const dvec3 eye(0, -2, 0);
    return probe.look(eye, eye + dvec3(std::sin(angle), std::cos(angle), 0));
}

TEST(CriticalAngle, bounds_snells_window) {
    const double critical = std::asin(1 / 1.33);
    for (const bool fresnel : {false, true}) {
        Probe probe(pool(fresnel));
        const double edge =
            find_edge(degrees(45), degrees(55), [&](double angle) { return seen_from_below(probe, angle).x > 0; });
        // sin(theta) n passes 1 within 9 roundings (direction, division, dot product): times tan(theta) as an angle.
        EXPECT_NEAR(edge, critical, 9 * rounding * std::tan(critical));
    }
    Probe window(pool(false));
    // Inside the window all of the sky, outside the bottom of the pool, mirrored.
    EXPECT_NEAR(seen_from_below(window, degrees(48)).x, 1, hit_roundings);
    EXPECT_EQ(seen_from_below(window, degrees(49)), dvec3(0));
}

TEST(TotalReflection, carries_the_weight_of_both_rays) {
    SceneBuilder b;
    SceneMaterial water = clear(1.33);
    water.reflection = 0.25f;
    water.transmission = 0.5f;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(water));
    b.add_plane({0, -5, 0}, {0, 1, 0}, b.add_material(emitter(glm::vec3(2))));
    b.scene.settings.background = dvec3(1);
    Probe probe(b.scene);
    EXPECT_EQ(seen_from_below(probe, degrees(40)).x, 0.5 * 1 + 0.25 * 2);
    EXPECT_EQ(seen_from_below(probe, degrees(60)).x, 0.75 * 2);
}

/// Reflectance by Fresnel's sine and tangent laws (Born and Wolf, 1.5.2), which share nothing with the program's form.
double fresnel(double i, double n1, double n2) {
    if (i == 0) return (n1 - n2) * (n1 - n2) / ((n1 + n2) * (n1 + n2));
    const double sine = std::sin(i) * n1 / n2;
    if (sine >= 1) return 1;
    const double r = std::asin(sine);
    const double s = std::sin(i - r) / std::sin(i + r), p = std::tan(i - r) / std::tan(i + r);
    return (s * s + p * p) / 2;
}

/// Glass below y = 0: what comes from above is in the first channel, from below in the second.
Scene glass_between_lamps(double share) {
    SceneBuilder b;
    SceneMaterial glass = clear(1.5);
    glass.fresnel = true;
    glass.reflection = static_cast<float>(share) / 4;  // only the sum matters
    glass.transmission = static_cast<float>(share) - glass.reflection;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(glass));
    b.add_plane({0, -5, 0}, {0, 1, 0}, b.add_material(emitter({0, 1, 1})));
    b.add_plane({0, 5, 0}, {0, -1, 0}, b.add_material(emitter({1, 0, 1})));
    return b.scene;
}

/// Errors of the cosine by 9 roundings; the reflectance changes by less than 1 / cos(i) of that, and at most by 1 /
/// cos(r) where it leaves the denser side.
double fresnel_bound(double i, double n1, double n2) {
    const double cos_i = std::cos(i), sin_r = std::sin(i) * n1 / n2;
    const double cos_r = sin_r < 1 ? std::sqrt(1 - sin_r * sin_r) : 1;
    return 9 * rounding * (1 + 1 / cos_i + n1 / n2 / cos_r);
}

TEST(Fresnel, splits_reflection_and_transmission_exactly_from_outside) {
    for (const double share : {1.0, 0.5}) {
        Probe probe(glass_between_lamps(share));
        for (const double angle : {0.0, 30.0, 56.309932, 75.0, 85.0, 89.0}) {  // the third is Brewster's
            SCOPED_TRACE(angle);
            const double i = degrees(angle), f = fresnel(i, 1, 1.5);
            const dvec3 d(std::sin(i), -std::cos(i), 0);
            expect_seen(probe, -2.0 * d, {0, 0, 0}, share * dvec3(f, 1 - f, 1), share * fresnel_bound(i, 1, 1.5));
        }
    }
}

TEST(Fresnel, splits_reflection_and_transmission_exactly_from_inside) {
    Probe probe(glass_between_lamps(1));
    for (const double angle : {0.0, 20.0, 33.690068, 40.0, 41.5, 42.0, 60.0}) {  // critical: 41.81
        SCOPED_TRACE(angle);
        const double i = degrees(angle), f = fresnel(i, 1.5, 1);
        const dvec3 d(std::sin(i), std::cos(i), 0);
        expect_seen(probe, -2.0 * d, {0, 0, 0}, {1 - f, f, 1}, fresnel_bound(i, 1.5, 1));
    }
}

TEST(Fresnel, at_brewsters_angle_reflects_half_of_what_the_perpendicular_part_reflects) {
    Probe probe(glass_between_lamps(1));
    const double i = std::atan(1.5);  // tan(i) = n: nothing of the parallel part
    const dvec3 d(std::sin(i), -std::cos(i), 0);
    const double s = (1 - 2.25) / (1 + 2.25);  // cos(2 i): r = 90 degrees - i
    EXPECT_NEAR(probe.look(-2.0 * d, {0, 0, 0}).x, s * s / 2, fresnel_bound(i, 1, 1.5));
}

TEST(Absorption, is_that_of_beer_and_lambert_along_the_refracted_path) {
    SceneMaterial glass = clear(1.5);
    glass.absorption = {0, 0.5f, 2};
    SceneBuilder b;
    const std::uint32_t id = b.add_material(glass);
    b.add_plane({0, 0, 0}, {0, 1, 0}, id);
    b.add_plane({0, -1.5f, 0}, {0, -1, 0}, id);
    b.scene.settings.background = dvec3(4);
    Probe probe(b.scene);
    for (const double angle : {0.0, 35.0, 70.0, 85.0}) {
        SCOPED_TRACE(angle);
        const double i = degrees(angle);
        const double length = 1.5 / std::cos(std::asin(std::sin(i) / 1.5));
        const dvec3 d(std::sin(i), -std::cos(i), 0);
        // I = I_0 exp(-sigma l); sigma l is at most 5, so its relative error counts five times.
        expect_seen(probe, -1.0 * d, {0, 0, 0}, {4, 4 * std::exp(-0.5 * length), 4 * std::exp(-2 * length)},
                    4 * 5 * hit_roundings * std::exp(-1));
    }
}

TEST(Absorption, dims_also_what_an_eye_in_the_medium_sees_and_reflections_within) {
    SceneMaterial glass = mirror(0.5);
    glass.emission = glm::vec3(1);
    glass.absorption = glm::vec3(0.25f);
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, b.add_material(glass));
    b.scene.settings.depth = 2;
    Probe probe(b.scene);
    // From the centre: 1 unit to the wall, then diameters of 2: e^-.25 (1 + .5 e^-.5 (1 + .5 e^-.5)).
    const double pass = 0.5 * std::exp(-0.5);
    expect_seen(probe, {0, 0, 0}, {1, 0.5, 0.25}, dvec3(std::exp(-0.25) * (1 + pass * (1 + pass))), 2 * hit_roundings);
}

TEST(Blend, of_a_scene_file_weighs_local_reflected_and_refracted_light) {
    Probe probe(scene_of(R"(
        [render]
        size = [1, 1]
        background = [4, 2, 1]
        [[material]]
        name = "varnish"
        ambient = 1.0
        diffuse = 0.0
        reflection = 0.25
        transmission = 0.5
        base_color = [1, 0.5, 0.25]
        ior = 1.25
        [[material]]
        name = "lamp"
        diffuse = 0.0
        emission = [8, 8, 8]
        [[light]]
        type = "ambient"
        color = 0.5
        [[object]]
        shape = "plane"
        material = "varnish"
        point = [0, 0, 0]
        normal = [0, 1, 0]
        [[object]]
        shape = "plane"
        material = "lamp"
        point = [0, -3, 0]
        normal = [0, 1, 0]
    )"));
    // I = (1 - r - t) k_a I_a + base (r I_reflected + t I_refracted), exact.
    expect_seen(probe, {1, 2, 0}, {0, 0, 0}, {0.125 + 1 + 4, 0.125 + 0.25 + 2, 0.125 + 0.0625 + 1}, 0);
}

}  // namespace
}  // namespace raymill::truths
