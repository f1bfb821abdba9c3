#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lib/random.h"
#include "reference/formulas.hpp"
#include "scene_builder.hpp"

namespace raymill::reference {
namespace {

SceneMaterial mirror(float reflection) {
    SceneMaterial material = black();
    material.reflection = reflection;
    return material;
}

SceneMaterial clear(float ior) {
    SceneMaterial material = black();
    material.transmission = 1;
    material.ior = ior;
    return material;
}

/// A slab 0 < z < thickness of planes whose normals face out.
void add_slab(SceneBuilder& b, float thickness, std::uint32_t material) {
    b.add_plane({0, 0, 0}, {0, 0, -1}, material);
    b.add_plane({0, 0, thickness}, {0, 0, 1}, material);
}

TEST(Emission, is_seen_from_both_sides_unless_it_is_one_sided) {
    SceneMaterial lamp = emitter({1, 2, 3});
    lamp.reflection = 0.5f;  // the blend does not weigh emission
    for (const bool one_sided : {false, true}) {
        lamp.one_sided_emission = one_sided;
        SceneBuilder b;
        b.add_plane({0, 0, 0}, {0, 0, 1}, b.add_material(lamp));
        EXPECT_EQ(radiance(b.scene, {{0, 0, 1}, {0, 0, -1}}), dvec3(1, 2, 3));
        EXPECT_EQ(radiance(b.scene, {{0, 0, -1}, {0, 0, 1}}), one_sided ? dvec3(0) : dvec3(1, 2, 3));
    }
}

TEST(Blend, weighs_local_light_and_colours_what_is_reflected_and_refracted) {
    SceneMaterial material = black();
    material.ambient = glm::vec3(1);
    material.reflection = 0.25f;
    material.transmission = 0.5f;
    material.base_color = {1, 0.5f, 0};
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 0, 1}, b.add_material(material));
    b.add_plane({0, 0, 9}, {0, 0, -1}, b.add_material(emitter(glm::vec3(8))));
    b.add_plane({0, 0, -9}, {0, 0, 1}, b.add_material(emitter(glm::vec3(2))));
    b.add_light(AmbientLight{glm::vec3(4)});
    // (1 - 3/4) 4 + base (8 / 4 + 2 / 2)
    EXPECT_EQ(radiance(b.scene, {{0, 0, 1}, {0, 0, -1}}), dvec3(1 + 3, 1 + 1.5, 1));
}

TEST(Depth, two_facing_mirrors_add_a_power_for_each_bounce_allowed) {
    SceneMaterial material = mirror(0.5f);
    material.emission = glm::vec3(1);
    SceneBuilder b;
    const std::uint32_t id = b.add_material(material);
    b.add_plane({0, 0, -1}, {0, 0, 1}, id);
    b.add_plane({0, 0, 1}, {0, 0, -1}, id);
    for (const int depth : {0, 1, 2, 10}) {
        b.scene.settings.depth = depth;
        // 1 + 1/2 + ... + 1/2^depth
        EXPECT_EQ(radiance(b.scene, {{0, 0, 0}, {0.1, 0, 1}}).x, 2 - std::ldexp(1, -depth));
    }
}

TEST(Depth, counts_from_the_depth_of_the_ray) {
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 0, 1}, b.add_material(mirror(1)));
    b.scene.settings.background = {1, 1, 1};
    b.scene.settings.depth = 2;
    const Tracer tracer(b.scene);
    EXPECT_EQ(tracer.radiance({{0, 0, 1}, {0, 0, -1}}, 1, 0, 0), dvec3(1));
    EXPECT_EQ(tracer.radiance({{0, 0, 1}, {0, 0, -1}}, 2, 0, 0), dvec3(0));
}

TEST(MinWeight, cuts_the_branches_that_weigh_less) {
    SceneMaterial material = mirror(0.5f);
    material.emission = glm::vec3(1);
    SceneBuilder b;
    const std::uint32_t id = b.add_material(material);
    b.add_plane({0, 0, -1}, {0, 0, 1}, id);
    b.add_plane({0, 0, 1}, {0, 0, -1}, id);
    b.scene.settings.depth = 20;
    b.scene.settings.min_weight = 0.25;
    EXPECT_EQ(radiance(b.scene, {{0, 0, 0}, {0, 0, 1}}).x, 1.75);  // weights 1, 1/2, 1/4
}

TEST(MinWeight, counts_what_was_absorbed_on_the_way) {
    SceneMaterial material = clear(1);
    material.absorption = glm::vec3(1);
    SceneBuilder b;
    add_slab(b, 2, b.add_material(material));
    b.scene.settings.background = {1, 1, 1};
    const Ray ray{{0, 0, -1}, {0, 0, 1}};
    b.scene.settings.min_weight = std::exp(-2) * 0.99;
    EXPECT_NEAR(radiance(b.scene, ray).x, std::exp(-2), rounding);
    b.scene.settings.min_weight = std::exp(-2) * 1.01;
    EXPECT_EQ(radiance(b.scene, ray).x, 0);
}

TEST(Branches, each_draws_light_samples_of_its_own_path) {
    SceneMaterial both = clear(1.5f);
    both.reflection = both.transmission = 0.5f;
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 0, 1}, b.add_material(both));
    b.add_plane({0, 0, 5}, {0, 0, -1});
    b.add_plane({0, 0, -5}, {0, 0, 1});
    b.scene.settings.shadows = ShadowMode::none;
    PointLight light;
    light.radius = 2;
    b.add_light(light);
    const Tracer tracer(b.scene);
    const Ray ray{{0.1, 0.2, 1}, {0, 0, -1}};
    double expected = 0;
    for (const std::uint32_t branch : {0u, 1u}) {
        const Ray child{{0.1, 0.2, 0}, {0, 0, branch == 0 ? 1.0 : -1.0}};
        const Hit hit = tracer.intersect(child);
        const Surface s = tracer.surface(child, hit);
        expected += 0.5 * tracer.local_terms(child, hit, s, 0, 0, 0, path_child(9, branch)).diffuse.x;
    }
    EXPECT_NEAR(tracer.radiance(ray, 0, 0, 9).x, expected, rounding);
}

TEST(Refraction, a_slab_shifts_the_ray_without_turning_it) {
    // A checkered wall behind the slab would show the shift; here the exit is followed ray by ray.
    SceneBuilder b;
    add_slab(b, 2, b.add_material(clear(1.5f)));
    const Tracer tracer(b.scene);
    const double angle = 0.7;
    Ray ray{{0, 0, -1}, {std::sin(angle), 0, std::cos(angle)}};
    for (int i = 0; i < 2; ++i) {
        const Hit hit = tracer.intersect(ray);
        const Surface s = tracer.surface(ray, hit);
        EXPECT_EQ(s.inside, i == 1);
        const Split split = tracer.split(ray, s);
        ASSERT_EQ(split.transmission, 1);
        ray = tracer.spawn(ray, hit, s, split.refracted);
    }
    expect_near(ray.direction, {std::sin(angle), 0, std::cos(angle)}, rounding);
    const double inner = std::asin(std::sin(angle) / 1.5);
    // Inside it advances by 2 tan(inner) instead of 2 tan(angle).
    EXPECT_NEAR(ray.origin.x, std::tan(angle) + 2 * std::tan(inner), rounding * 10);
}

TEST(Refraction, a_ray_is_trapped_in_a_slab_beyond_the_critical_angle) {
    SceneMaterial material = clear(1.5f);
    material.reflection = 0.25f;
    material.transmission = 0.75f;
    SceneBuilder b;
    add_slab(b, 1, b.add_material(material));
    b.scene.settings.background = {1, 1, 1};
    b.scene.settings.depth = 8;
    const double critical = std::asin(1 / 1.5);
    const auto escapes = [&](double angle) {
        return radiance(b.scene, {{0, 0, 0.5}, {std::sin(angle), 0, std::cos(angle)}}).x;
    };
    EXPECT_EQ(escapes(critical + 1e-6), 0);  // whatever leaves would see the background
    // Every wall lets out three quarters of what reaches it, eight times: 3/4 (1 + 1/4 + ... + 4^-7).
    EXPECT_NEAR(escapes(critical - 1e-6), 1 - std::pow(0.25, 8), rounding);
}

TEST(Refraction, fresnel_loses_nothing_between_reflection_and_transmission) {
    SceneMaterial material = clear(1.5f);
    material.fresnel = true;
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 0, 1}, b.add_material(material));
    b.add_plane({0, 0, -5}, {0, 0, 1}, b.add_material(emitter({0, 1, 1})));
    b.add_plane({0, 0, 5}, {0, 0, -1}, b.add_material(emitter({1, 0, 1})));
    const double angle = 1.2;
    const dvec3 color = radiance(b.scene, {{0, 0, 1}, {std::sin(angle), 0, -std::cos(angle)}});
    const double f = fresnel(std::cos(angle), 1.5);
    expect_near(color, {f, 1 - f, 1}, rounding);
}

TEST(Absorption, follows_beer_and_lambert_along_the_inner_path) {
    SceneMaterial material = clear(1.5f);
    material.absorption = {0, 0.5f, 2};
    SceneBuilder b;
    add_slab(b, 2, b.add_material(material));
    b.scene.settings.background = {1, 1, 1};
    const double angle = 0.6;
    const dvec3 color = radiance(b.scene, {{0, 0, -1}, {3 * std::sin(angle), 0, 3 * std::cos(angle)}});
    const double length = 2 / std::cos(std::asin(std::sin(angle) / 1.5));
    expect_near(color, {1, std::exp(-0.5 * length), std::exp(-2 * length)}, rounding);
}

TEST(Absorption, dims_everything_a_hit_from_inside_brings_home) {
    SceneMaterial material = black();
    material.emission = glm::vec3(1);
    material.ambient = glm::vec3(1);
    material.absorption = glm::vec3(0.25f);
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 3, b.add_material(material));
    b.add_light(AmbientLight{});
    EXPECT_NEAR(radiance(b.scene, {{0, 0, 1}, {0, 0, 0.5}}).x, 2 * std::exp(-0.5), rounding);  // two units away
    EXPECT_EQ(radiance(b.scene, {{0, 0, 5}, {0, 0, -1}}).x, 2);                                // from outside
}

/// A white floor y = 0 under a point light at (0, 4, 0), to be shadowed by what is added.
SceneBuilder floor_under_a_light() {
    SceneBuilder b;
    SceneMaterial white;
    white.diffuse = glm::vec3(1);
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(white));
    PointLight light;
    light.position = {0, 4, 0};
    b.add_light(light);
    return b;
}

const Ray at_floor{{3, 1, 0}, {-3, -1, 0}};  // to the origin, straight below the light

TEST(Shadow, a_blocked_light_adds_nothing_and_what_lies_beyond_it_does_not_block) {
    SceneBuilder b = floor_under_a_light();
    b.add_sphere({0, 6, 0}, 1);
    EXPECT_EQ(radiance(b.scene, at_floor), dvec3(1));
    b.add_sphere({0, 2, 0}, 1);
    EXPECT_EQ(radiance(b.scene, at_floor), dvec3(0));
    b.scene.settings.shadows = ShadowMode::opaque;
    EXPECT_EQ(radiance(b.scene, at_floor), dvec3(0));
    b.scene.settings.shadows = ShadowMode::none;
    EXPECT_EQ(radiance(b.scene, at_floor), dvec3(1));
}

TEST(Shadow, a_filter_colours_the_light_once_for_each_surface_crossed) {
    SceneMaterial glass = clear(1.5f);
    glass.transmission = 0.5f;
    glass.base_color = {1, 0.5f, 0};
    SceneBuilder pane = floor_under_a_light();
    const std::uint32_t id = pane.add_material(glass);
    // The shadow ray passes through the edge that both triangles share.
    pane.add_quad({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, id);
    EXPECT_EQ(radiance(pane.scene, at_floor), dvec3(0.5, 0.25, 0));
    SceneBuilder ball = floor_under_a_light();
    ball.add_sphere({0.1f, 2, 0}, 1, ball.add_material(glass));  // in and out
    EXPECT_EQ(radiance(ball.scene, at_floor), dvec3(0.25, 0.0625, 0));
    ball.scene.settings.shadows = ShadowMode::opaque;
    EXPECT_EQ(radiance(ball.scene, at_floor), dvec3(0));
}

TEST(Shadow, the_inside_of_a_filtering_sphere_is_lit_through_its_far_side) {
    SceneMaterial glass;
    glass.diffuse = glm::vec3(1);
    glass.transmission = 0.5f;
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, b.add_material(glass));
    PointLight light;
    light.position = {0, 4, 0};
    b.add_light(light);
    b.scene.settings.depth = 0;
    // From within to the lowest point: normal up, light straight above, through the top once; the blend halves it.
    EXPECT_NEAR(radiance(b.scene, {{0, 0, 0}, {0, -1, 0}}).x, 0.5 * 0.5, rounding);
}

TEST(Shadow, of_a_visible_area_light_is_not_cast_by_its_own_surface) {
    for (const bool sphere : {false, true}) {
        SceneBuilder b;
        SceneMaterial white;
        white.diffuse = glm::vec3(1);
        b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(white));
        const std::uint32_t lamp = b.add_material(emitter(glm::vec3(1)));
        if (sphere) {
            SphereLight light;
            light.center = {0, 3, 0};
            b.add_light(light, 16);
            b.add_sphere({0, 3, 0}, 1, lamp);
        } else {
            RectangleLight light;
            light.center = {0, 3, 0};
            light.edge_u = {0, 0, -1};
            light.edge_v = {1, 0, 0};
            b.add_light(light, 16);
            b.add_quad({-0.5f, 3, -0.5f}, {0.5f, 3, -0.5f}, {0.5f, 3, 0.5f}, {-0.5f, 3, 0.5f}, lamp);
        }
        Scene unshadowed = b.scene;
        unshadowed.settings.shadows = ShadowMode::none;
        EXPECT_GT(radiance(b.scene, at_floor).x, 0);
        EXPECT_EQ(radiance(b.scene, at_floor), radiance(unshadowed, at_floor));
    }
}

TEST(Shadow, a_lit_sphere_has_no_acne_at_any_scale) {
    for (const float scale : {1e-3f, 1.0f, 1e6f}) {
        SceneBuilder b;
        SceneMaterial white;
        white.diffuse = glm::vec3(1);
        const glm::vec3 center = glm::vec3(1000, -500, 20) * scale;
        b.add_sphere(center, scale, b.add_material(white));
        DirectionalLight light;
        light.direction = {0, 0, -1};
        b.add_light(light);
        b.scene.settings.width = b.scene.settings.height = 32;
        b.scene.camera.projection = Projection::orthographic;
        b.scene.camera.look_at = center;
        b.scene.camera.eye = b.scene.camera.look_at + glm::dvec3(0, 0, 4.0 * scale);
        b.scene.camera.height = 2.0 * scale;
        const Tracer tracer(b.scene);
        for (int i = 0; i < 32 * 32; ++i) {
            const glm::dvec4 pixel = tracer.pixel(i % 32, i / 32);
            const dvec2 p = (dvec2(i % 32, i / 32) + 0.5) / 16.0 - 1.0;
            EXPECT_EQ(pixel.a, glm::dot(p, p) < 1 ? 1 : 0);
            // The normal's z: coordinates a thousand radii from zero round by 1e-13 of it, and the rim is steep.
            if (pixel.a == 1) {
                EXPECT_NEAR(pixel.x, std::sqrt(1 - glm::dot(p, p)), 1e-10);
            }
        }
    }
}

TEST(Pixel, a_scene_scaled_by_a_power_of_two_has_the_same_pixels_to_the_last_bit) {
    const auto render = [](float scale) {
        SceneBuilder b;
        SceneMaterial shiny;
        shiny.specular = glm::vec3(0.5f);
        shiny.reflection = 0.3f;
        const std::uint32_t id = b.add_material(shiny);
        b.add_quad(glm::vec3(-4, 0, 4) * scale, glm::vec3(4, 0, 4) * scale, glm::vec3(4, 0, -4) * scale,
                   glm::vec3(-4, 0, -4) * scale, id);
        b.add_sphere(glm::vec3(0, 1, 0) * scale, scale, id);
        PointLight light;
        light.position = glm::vec3(2, 4, 3) * scale;
        light.radius = 0.25f * scale;
        b.add_light(light, 4);
        b.scene.settings.width = b.scene.settings.height = 8;
        b.scene.camera.eye *= scale;
        b.scene.camera.look_at *= scale;
        b.scene.camera.aperture = 0.125 * scale;
        const Tracer tracer(b.scene);
        std::vector<glm::dvec4> pixels;
        for (int i = 0; i < 64; ++i) pixels.push_back(tracer.pixel(i % 8, i / 8));
        return pixels;
    };
    const auto expected = render(1);
    EXPECT_EQ(render(std::ldexp(1.0f, 20)), expected);
    EXPECT_EQ(render(std::ldexp(1.0f, -20)), expected);
}

}  // namespace
}  // namespace raymill::reference
