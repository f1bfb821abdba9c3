// Hard shadows: where their edges fall, and what passes through transmissive surfaces.
#include <array>
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

/// A white floor y = 0.
SceneBuilder white_floor() {
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(white()));
    return b;
}

/// A half-plane x > edge at this height.
void add_half_plane(SceneBuilder& b, float edge, float height, std::uint32_t material = 0) {
    b.add_quad({edge, height, -9}, {99, height, -9}, {99, height, 9}, {edge, height, 9}, material);
}

/// Seen from below the half-plane.
dvec3 floor_seen(Probe& probe, double x) {
    return probe.look({x - 0.5, 0.5, 0.1}, {x, 0, 0.1});
}
double shadow_edge(Probe& probe, double lit, double dark) {
    return find_edge(lit, dark, [&](double x) { return floor_seen(probe, x).x > 0; });
}

TEST(ShadowEdge, of_a_point_light_lies_where_similar_triangles_put_it) {
    for (const float height : {0.75f, 1.0f, 2.5f}) {
        SCOPED_TRACE(height);
        SceneBuilder b = white_floor();
        add_half_plane(b, 0.25f, height);
        b.add_light(point_light({-1, 4, 0.3}));
        Probe probe(b.scene);
        // x = L.x + (e - L.x) L.y / (L.y - h)
        const double expected = -1 + 1.25 * 4 / (4 - static_cast<double>(height));
        // The floor point is off by the hit's roundings; the shadow ray's direction and the triangle test by as many,
        // over a distance below 6.
        EXPECT_NEAR(shadow_edge(probe, expected - 0.3, expected + 0.3), expected, 7 * hit_roundings);
    }
}

TEST(ShadowEdge, of_a_directional_light_lies_along_its_direction) {
    SceneBuilder b = white_floor();
    add_half_plane(b, 0.25f, 2);
    b.add_light(directional_light({-1, -2, 0}));
    Probe probe(b.scene);
    EXPECT_NEAR(shadow_edge(probe, -1.5, -0.5), 0.25 - 2 * 0.5, 3 * hit_roundings);  // x = e + h d.x / -d.y
}

TEST(ShadowEdge, of_a_sphere_is_where_the_tangent_from_the_light_meets_the_floor) {
    SceneBuilder b = white_floor();
    b.add_sphere({0, 2, 0.1f}, 0.5f);
    b.add_light(point_light({0, 5, 0.1}));
    Probe probe(b.scene);
    // The tangent makes asin(r / d) with the axis: x = H tan(asin(0.5 / 3)).
    const double expected = 5 * std::tan(std::asin(0.5 / 3));
    // A discriminant's rounding moves the tangent by the same share of r^2 over 2 r: no more than the other terms.
    EXPECT_NEAR(shadow_edge(probe, 1.2, 0.5), expected, 7 * hit_roundings);
}

TEST(Shadow, a_blocked_light_adds_nothing_and_leaves_ambient_and_other_lights) {
    SceneBuilder b = white_floor();
    b.scene.materials[1].ambient = glm::vec3(1);
    add_half_plane(b, 0, 2);
    b.add_light(AmbientLight{glm::vec3(0.125f)});
    b.add_light(directional_light({0, -1, 0}, 4));       // blocked at x = 1
    b.add_light(directional_light({0, -1, 0}, 0.5), 4);  // as well, by four samples
    b.add_light(directional_light({3, -4, 0}, 2));       // comes from the left: cos = 4 / 5
    Probe probe(b.scene);
    expect_seen(probe, {0.5, 0.5, 0}, {1, 0, 0}, dvec3(0.125 + 1.6), 2 * hit_roundings);
    expect_seen(probe, {-2.5, 0.5, 0}, {-2, 0, 0}, dvec3(0.125 + 4.5 + 1.6), 6 * hit_roundings);
}

TEST(Shadow, a_surface_beyond_the_light_does_not_block_it) {
    SceneBuilder b = white_floor();
    add_half_plane(b, -50, 2);
    b.add_light(point_light({0, 1.875, 0}));
    Probe probe(b.scene);
    expect_seen(probe, {0.25, 0.5, 0}, {0, 0, 0}, dvec3(1), hit_roundings);
}

SceneMaterial sheet(const glm::vec3& color, float transmission) {
    SceneMaterial material = clear(1.5);
    material.base_color = color;
    material.transmission = transmission;
    return material;
}

/// What comes through these sheets, from the top down, of white light that falls straight on a white floor.
dvec3 through(const std::vector<SceneMaterial>& sheets, ShadowMode mode) {
    SceneBuilder b = white_floor();
    float height = 3;
    for (const SceneMaterial& material : sheets) add_half_plane(b, -0.5f, height -= 0.5f, b.add_material(material));
    b.add_light(directional_light({0, -1, 0}));
    b.scene.settings.shadows = mode;
    Probe probe(b.scene);
    const dvec3 seen = floor_seen(probe, 0.25);
    EXPECT_EQ(seen, probe.look_by_reference({-0.25, 0.5, 0.1}, {0.25, 0, 0.1}));
    return seen;
}

TEST(FilteredShadow, two_coloured_sheets_multiply_in_either_order) {
    const SceneMaterial red = sheet({1, 0.5f, 0.25f}, 0.5f), blue = sheet({0.25f, 0.5f, 1}, 0.75f);
    // Each crossing multiplies by transmission times base colour: short binary fractions, exact.
    const dvec3 both(0.5 * 0.1875, 0.25 * 0.375, 0.125 * 0.75);
    EXPECT_EQ(through({red}, ShadowMode::filtered), dvec3(0.5, 0.25, 0.125));
    EXPECT_EQ(through({red, blue}, ShadowMode::filtered), both);
    EXPECT_EQ(through({blue, red}, ShadowMode::filtered), both);
}

TEST(FilteredShadow, a_glass_sphere_filters_twice_and_an_opaque_thing_behind_it_blocks) {
    SceneBuilder b = white_floor();
    b.add_sphere({0.25f, 2, 0}, 0.5f, b.add_material(sheet({1, 0.5f, 0.25f}, 0.5f)));
    b.add_light(directional_light({0, -1, 0}));
    Probe probe(b.scene);
    expect_seen(probe, {-0.25, 0.5, 0.1}, {0.25, 0, 0.1}, {0.25, 0.0625, 0.015625}, 0);
    add_half_plane(b, -50, 4);
    Probe covered(b.scene);
    expect_seen(covered, {-0.25, 0.5, 0.1}, {0.25, 0, 0.1}, dvec3(0), 0);
}

TEST(ShadowMode, opaque_blocks_at_any_hit_and_none_lets_everything_pass) {
    const SceneMaterial pane = sheet(glm::vec3(1), 1);
    EXPECT_EQ(through({pane}, ShadowMode::filtered), dvec3(1));
    EXPECT_EQ(through({pane}, ShadowMode::opaque), dvec3(0));
    EXPECT_EQ(through({pane}, ShadowMode::none), dvec3(1));
    EXPECT_EQ(through({SceneMaterial{}}, ShadowMode::filtered), dvec3(0));
    EXPECT_EQ(through({SceneMaterial{}}, ShadowMode::none), dvec3(1));
}

}  // namespace
}  // namespace raymill::truths
