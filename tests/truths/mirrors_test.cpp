// Mirrors: where images are, how often light goes to and fro, and what colour it comes back with.
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

TEST(Mirror, shows_a_thing_where_its_mirror_image_is) {
    const dvec3 n = glm::normalize(dvec3(-1, 0.25, 0.125));  // of a mirror through (3, 0, 0)
    SceneBuilder b;
    SceneMaterial material = mirror(0.5);
    b.add_plane({3, 0, 0}, n, b.add_material(material));
    add_ruler(b, {-2, -2, -2}, {4, 0, 0}, {0, 4, 0});  // at z = -2, facing +z
    Probe probe(b.scene);
    const dvec3 eye(-1, 0.5, 2);
    for (const dvec2 point : {dvec2(-1.5, -0.5), dvec2(0, 0), dvec2(0.5, 1.25), dvec2(1.5, -1)}) {
        SCOPED_TRACE(testing::Message() << point.x << ' ' << point.y);
        const dvec3 thing(point, -2);
        const dvec3 image = thing - 2 * glm::dot(thing - dvec3(3, 0, 0), n) * n;
        const dvec3 seen = probe.look(eye, image);
        EXPECT_NEAR(seen.z, 0.5, hit_roundings);
        // The ray is 10 units long and meets the ruler at up to 60 degrees; the ruler's unit is 4.
        const double bound = 10 * 2 * hit_roundings / 4;
        EXPECT_NEAR(reading(seen).x, (point.x + 2) / 4, bound);
        EXPECT_NEAR(reading(seen).y, (point.y + 2) / 4, bound);
    }
}

/// Two mirrors at z = -1 and z = 1 that keep half of the light, and a ruler across the way at x = 5.
Scene two_mirrors(int depth) {
    SceneBuilder b;
    const std::uint32_t id = b.add_material(mirror(0.5));
    b.add_plane({0, 0, -1}, {0, 0, 1}, id);
    b.add_plane({0, 0, 1}, {0, 0, -1}, id);
    add_ruler(b, {5, -1, -1}, {0, 0, 2}, {0, 2, 0});  // faces -x: z x y
    b.scene.settings.depth = depth;
    return b.scene;
}

TEST(TwoMirrors, show_images_of_images_where_unfolding_puts_them_one_power_dimmer_each) {
    const int depth = 12;
    Probe probe(two_mirrors(depth));
    const dvec3 eye(0, 0.25, 0);
    for (const int order : {0, 1, 2, 3, 7, 12}) {
        SCOPED_TRACE(order);
        // The k-th image of the ruler is centred on z = 2 k; odd ones are mirrored.
        const double z = 0.375, sign = order % 2 == 0 ? 1 : -1;
        const dvec3 seen = probe.look(eye, {5, 0.5, 2.0 * order + sign * z});
        EXPECT_NEAR(seen.z, std::ldexp(1, -order), hit_roundings);
        // Each bounce adds the roundings of a hit on coordinates up to 5, along a path of up to 25 units.
        const double bound = (25 + 5 * order) * hit_roundings / 2;
        EXPECT_NEAR(reading(seen).x, (z + 1) / 2, bound);
        EXPECT_NEAR(reading(seen).y, (0.5 + 1) / 2, bound);
    }
}

TEST(TwoMirrors, show_nothing_that_takes_more_reflections_than_the_depth_allows) {
    for (const int depth : {0, 1, 4}) {
        Probe probe(two_mirrors(depth));
        EXPECT_GT(probe.look({0, 0.25, 0}, {5, 0.5, 2.0 * depth}).z, 0);
        EXPECT_EQ(probe.look({0, 0.25, 0}, {5, 0.5, 2.0 * (depth + 1)}).z, 0);
    }
}

TEST(TwoMirrors, add_a_power_of_what_they_keep_for_each_reflection) {
    SceneMaterial material = mirror(0.5);
    material.emission = glm::vec3(1);
    SceneBuilder b;
    const std::uint32_t id = b.add_material(material);
    b.add_plane({0, 0, -1}, {0, 0, 1}, id);
    b.add_plane({0, 0, 1}, {0, 0, -1}, id);
    for (const int depth : {0, 1, 2, 7, 20}) {
        SCOPED_TRACE(depth);
        b.scene.settings.depth = depth;
        Probe probe(b.scene);
        // 1 + 1/2 + ... + 1/2^depth, each an exact number of film units.
        expect_seen(probe, {0, 0, 0}, {0.125, 0, 1}, dvec3(2 - std::ldexp(1, -depth)), rounding);
    }
}

TEST(Mirror, colours_what_it_reflects_and_two_multiply) {
    SceneMaterial first = mirror(0.5), second = mirror(0.75);
    first.base_color = {0.5f, 1, 0.25f};
    second.base_color = {1, 0.25f, 0.5f};
    SceneBuilder b;
    // A periscope: two mirrors at 45 degrees, then a lamp.
    b.add_triangle({glm::vec3(-1, -1, -1), glm::vec3(1, 1, -1), glm::vec3(0, 0, 2)}, b.add_material(first));
    b.add_triangle({glm::vec3(-1, 4, -1), glm::vec3(1, 6, -1), glm::vec3(0, 5, 2)}, b.add_material(second));
    b.add_plane({9, 0, 0}, {-1, 0, 0}, b.add_material(emitter({4, 4, 4})));
    Probe probe(b.scene);
    // I = (r1 b1) (r2 b2) L: short binary fractions, exact.
    expect_seen(probe, {-4, 0, 0.1}, {0, 0, 0.1}, {0.75, 0.375, 0.1875}, 0);
}

TEST(Mirror, keeps_of_its_own_light_what_it_does_not_reflect) {
    SceneMaterial material = white();
    material.ambient = glm::vec3(1);
    material.reflection = 0.75f;
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    b.add_light(AmbientLight{glm::vec3(0.5f)});
    b.add_light(directional_light({0, -1, 0}, 2));
    b.scene.settings.background = dvec3(8, 4, 0);
    Probe probe(b.scene);
    // I = (1 - r) (k_a I_a + k_d I_in) + r background, exact.
    expect_seen(probe, {1, 2, 0}, {0, 0, 0}, {0.625 + 6, 0.625 + 3, 0.625}, 0);
}

}  // namespace
}  // namespace raymill::truths
