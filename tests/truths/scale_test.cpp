// Scale and place change nothing: no acne anywhere, and powers of two not even a bit.
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

constexpr int size = 48;

struct Place {
    float scale;
    glm::vec3 center;  // in units of the scale
};

/// An orthographic picture of things lit from behind the camera, which looks along -z at `place`.
Scene lit_from_the_camera(SceneBuilder b, const Place& place, ShadowOffset offset) {
    b.add_light(directional_light({0, 0, -1}));
    RenderSettings& settings = b.scene.settings;
    settings.width = settings.height = size;
    settings.shadow_offset = offset;
    b.scene.camera.projection = Projection::orthographic;
    b.scene.camera.look_at = dvec3(place.center) * static_cast<double>(place.scale);
    b.scene.camera.eye = b.scene.camera.look_at + dvec3(0, 0, 4.0 * place.scale);
    b.scene.camera.height = 2.0 * place.scale;
    return b.scene;
}

/// Pixels that hit something and get no light: each is in its own shadow, since all face the light.
int falsely_dark(const Scene& scene) {
    const Frame frame = Probe(scene).frame();
    int dark = 0, hit = 0;
    for (std::size_t i = 0; i < frame.rgba.size(); i += 4) {
        hit += frame.rgba[i + 3] > 0;
        dark += frame.rgba[i + 3] > 0 && frame.rgba[i] == 0;
    }
    EXPECT_GT(hit, size * size / 2);
    return dark;
}

Scene sphere_at(const Place& place, ShadowOffset offset) {
    SceneBuilder b;
    b.add_sphere(place.center * place.scale, place.scale, b.add_material(white()));
    return lit_from_the_camera(b, place, offset);
}

/// A slanted square of two triangles, larger than the view.
Scene square_at(const Place& place, ShadowOffset offset) {
    SceneBuilder b;
    const std::uint32_t id = b.add_material(white());
    const auto corner = [&](float x, float y) {
        return (place.center + glm::vec3(x, y, 0.7f * x - 0.4f * y)) * place.scale;
    };
    b.add_quad(corner(-2, -2), corner(2, -2), corner(2, 2), corner(-2, 2), id);
    return lit_from_the_camera(b, place, offset);
}

const Place places[] = {{1e-3f, glm::vec3(0)}, {1, glm::vec3(0)},           {1e6f, glm::vec3(0)},
                        {1, {1000, -500, 20}}, {1e-3f, {3000, 7000, -900}}, {1e6f, {-100, 50, 300}}};

TEST(Acne, is_on_no_pixel_at_any_scale_and_far_from_the_origin) {
    for (const Place& place : places) {
        SCOPED_TRACE(testing::Message() << place.scale << " at " << place.center.x);
        EXPECT_EQ(falsely_dark(sphere_at(place, ShadowOffset::robust)), 0);
        EXPECT_EQ(falsely_dark(square_at(place, ShadowOffset::robust)), 0);
    }
}

TEST(Acne, is_there_to_be_seen_when_the_offset_is_off) {
    EXPECT_GT(falsely_dark(sphere_at(places[3], ShadowOffset::none)), 0);
    EXPECT_GT(falsely_dark(square_at(places[3], ShadowOffset::none)), 0);
}

/// The film of a scene with a bit of everything, in a world this many times larger.
std::vector<cl_long> film_at_scale(float scale) {
    SceneBuilder b;
    SceneMaterial shiny;
    shiny.specular = glm::vec3(0.5f);
    shiny.reflection = 0.3f;
    const std::uint32_t id = b.add_material(shiny), glass = b.add_material(clear(1.5));
    b.add_quad(glm::vec3(-4, 0, 4) * scale, glm::vec3(4, 0, 4) * scale, glm::vec3(4, 0, -4) * scale,
               glm::vec3(-4, 0, -4) * scale, id);
    b.add_sphere(glm::vec3(0, 1, 0) * scale, scale, glass);
    b.add_sphere(glm::vec3(1.5f, 0.7f, -1.3f) * scale, 0.7f * scale, id);
    b.add_plane(glm::vec3(0, 0, -4) * scale, {0, 0, 1}, id);
    PointLight light = point_light(dvec3(2, 4, 3) * static_cast<double>(scale));
    light.radius = 0.25f * scale;
    b.add_light(light, 4);
    b.scene.settings.width = b.scene.settings.height = 24;
    b.scene.settings.background = dvec3(0.2, 0.3, 0.5);
    b.scene.camera.eye *= scale;
    b.scene.camera.look_at *= scale;
    b.scene.camera.aperture = 0.125 * scale;
    return Probe(b.scene).frame().sums;
}

TEST(Scale, by_a_power_of_two_changes_no_bit_of_the_film) {
    // A power of two is exact in every product, sum and root, as long as nothing underflows.
    const auto expected = film_at_scale(1);
    EXPECT_EQ(film_at_scale(std::ldexp(1.0f, 20)), expected);
    EXPECT_EQ(film_at_scale(std::ldexp(1.0f, -10)), expected);
    EXPECT_NE(film_at_scale(1.1f), expected);
}

}  // namespace
}  // namespace raymill::truths
