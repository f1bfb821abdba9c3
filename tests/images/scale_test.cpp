// A scene scaled by a power of two is the same picture to the last bit: no length is hidden in a kernel.
#include <gtest/gtest.h>

#include <cmath>

#include "rendering.hpp"

namespace raymill {
namespace {

std::string still_life_toml() {
    return R"(
[render]
size = [40, 30]
depth = 4
spp = 2
background = [0.2, 0.3, 0.5]
[camera]
eye = [0.3, 1.7, 5]
look_at = [0, 0.7, 0]
aperture = 0.05
focus = 4.5
[[material]]
name = "glass"
diffuse = 0.1
reflection = 0.2
transmission = 0.7
fresnel = true
absorption = [0.5, 0.125, 0.25]
[[material]]
name = "mirror"
reflection = 0.6
specular = 0.5
[[material]]
name = "checker"
diffuse_checker = { a = 0.9, b = 0.2, scale = 0.3 }
[[light]]
type = "point"
position = [2, 4, 3]
intensity = 0.6
[[light]]
type = "point"
position = [-2, 3, 2]
intensity = 0.3
radius = 0.25
[[light]]
type = "rectangle"
center = [0, 3, 1]
edge_u = [1, 0, 0]
edge_v = [0, 0, 1]
radiance = 2
[[light]]
type = "sphere"
center = [1.5, 2.5, -1]
radius = 0.25
radiance = 5
[[object]]
shape = "plane"
material = "checker"
point = [0, -0.01, 0]
normal = [0.05, 1, 0.02]
[[object]]
shape = "sphere"
material = "glass"
center = [-0.9, 0.9, 0.2]
radius = 0.8
[[object]]
shape = "box"
material = "mirror"
min = [0.3, 0.1, -0.6]
max = [1.5, 1.2, 0.5]
rotate = [0, 20, 0]
[[object]]
material = "glass"
)" + sphere_mesh_keys(0.3, 0.5, 1.6, 0.4, 6);
}

void scale_numbers(float (&numbers)[3], float factor) {
    for (float& number : numbers) number *= factor;
}

void scale_light(SceneLight& light, float factor) {
    if (auto* point = std::get_if<PointLight>(&light.light)) {
        point->position *= factor;
        point->radius *= factor;
    } else if (auto* rectangle = std::get_if<RectangleLight>(&light.light)) {
        rectangle->center *= factor;
        rectangle->edge_u *= factor;
        rectangle->edge_v *= factor;
    } else if (auto* sphere = std::get_if<SphereLight>(&light.light)) {
        sphere->center *= factor;
        sphere->radius *= factor;
    } else {
        FAIL() << "this scene has other lights than those scaled here";
    }
}

/// The scene 2^exponent times as large; exact, as no number leaves the range of floats.
Scene scaled(Scene scene, int exponent) {
    const float factor = std::ldexp(1.0f, exponent);
    for (Vertex& vertex : scene.vertices) scale_numbers(vertex.position, factor);
    for (Sphere& sphere : scene.spheres) {
        scale_numbers(sphere.center, factor);
        sphere.radius *= factor;
    }
    for (Plane& plane : scene.planes) scale_numbers(plane.point, factor);
    for (SceneLight& light : scene.lights) scale_light(light, factor);
    for (SceneMaterial& material : scene.materials) {
        material.absorption /= factor;
        if (material.diffuse_checker) material.diffuse_checker->scale *= factor;
    }
    for (glm::dvec3* point : {&scene.camera.eye, &scene.camera.look_at}) *point *= factor;
    scene.camera.aperture *= factor;
    scene.camera.focus *= factor;
    return scene;
}

TEST(a_scene_scaled_by_a_power_of_two, is_the_same_picture_to_the_last_bit) {
    const Scene scene = scene_of(still_life_toml());
    const Frame expected = render(scene);
    for (const int exponent : {-10, 10, 20}) {
        const Frame frame = render(scaled(scene, exponent));
        EXPECT_EQ(frame.hash(), expected.hash())
            << "2^" << exponent << ": " << differing_pixels(frame, expected) << " pixels differ";
        EXPECT_EQ(frame.rays.total(), expected.rays.total());
    }
}

TEST(a_scene_scaled_by_a_power_of_two, is_another_picture_under_an_attenuated_light) {
    Scene scene = scene_of(still_life_toml());
    for (SceneLight& light : scene.lights)
        if (auto* point = std::get_if<PointLight>(&light.light)) point->attenuation = {1, 0.1f, 0};
    EXPECT_GT(differing_pixels(render(scaled(scene, 10)), render(scene)), pixel_count(scene) / 10);
}

}  // namespace
}  // namespace raymill
