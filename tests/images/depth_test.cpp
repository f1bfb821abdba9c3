// How deep rays go, counted in closed form; and queues of a few rays, which hold all of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "rendering.hpp"

namespace raymill {
namespace {

/// Between two facing mirrors of reflectance 1/2 that glow with radiance 1.
Scene between_mirrors(int depth, double min_weight = 0) {
    return scene_of(fmt::format(R"(
[render]
size = [9, 7]
depth = {}
min_weight = {}
[camera]
eye = [0, 0, 0]
look_at = [0, 0, 1]
fov = 20
[[material]]
name = "mirror"
diffuse = 0
reflection = 0.5
emission = 1.0
[[object]]
shape = "plane"
material = "mirror"
point = [0, 0, 2]
normal = [0, 0, -1]
[[object]]
shape = "plane"
material = "mirror"
point = [0, 0, -2]
normal = [0, 0, 1]
)",
                                depth, min_weight));
}

/// Every pixel is `radiance` (a sum of powers of two: exact), of `children` secondary rays.
void expect_all(const Scene& scene, float radiance, std::uint64_t children) {
    const Frame frame = render(scene);
    for (std::size_t i = 0; i < frame.rgba.size(); i += FILM_CHANNELS) {
        ASSERT_EQ(frame.rgba[i], radiance) << "pixel " << i / FILM_CHANNELS;
        ASSERT_EQ(frame.rgba[i + 3], 1.0f);
    }
    EXPECT_EQ(frame.rays.camera, pixel_count(scene));
    EXPECT_EQ(frame.rays.secondary, children * pixel_count(scene));
}

TEST(facing_mirrors, reflect_as_often_as_the_depth_says) {
    expect_all(between_mirrors(0), 1.0f, 0);
    expect_all(between_mirrors(1), 1.5f, 1);
    expect_all(between_mirrors(2), 1.75f, 2);
    expect_all(between_mirrors(10), 2.0f - 1.0f / 1024, 10);
}

TEST(facing_mirrors, reflect_until_the_weight_falls_below_the_least_one) {
    expect_all(between_mirrors(10, 0.5), 1.5f, 1);
    expect_all(between_mirrors(10, 0.51), 1.0f, 0);
    expect_all(between_mirrors(10, 0.2), 1.75f, 2);
}

TEST(a_ray_of_the_last_depth, that_misses_still_brings_the_background) {
    Scene scene = between_mirrors(1);
    scene.planes.pop_back();
    scene.settings.background = glm::dvec3(4);
    expect_all(scene, 1.0f + 0.5f * 4, 1);
}

/// Nothing but glass in a glass box: every ray has two children.
Scene all_glass(int depth) {
    return scene_of(fmt::format(R"(
[render]
size = [8, 6]
depth = {}
spp = 3
[camera]
eye = [0, 0.2, 3]
look_at = [0, 0, 0]
[[material]]
name = "glass"
diffuse = 0.3
reflection = 0.4
transmission = 0.5
ior = 1.1
[[light]]
type = "directional"
direction = [-1, -2, -1]
[[object]]
shape = "sphere"
material = "glass"
center = [0, 0, 0]
radius = 0.9
[[object]]
shape = "box"
material = "glass"
min = [-5, -5, -5]
max = [5, 5, 5]
[[object]]
material = "glass"
{})",
                                depth, sphere_mesh_keys(0.1, 0, 0, 0.5, 4)));
}

TEST(a_queue_of_a_few_rays, never_overflows_where_all_is_glass) {
    const Scene scene = all_glass(4);
    const Frame expected = render(scene);
    // Two children a hit but for total reflection, in a box that no ray of depth 0 misses.
    EXPECT_GT(expected.rays.secondary, 8 * expected.rays.camera);
    for (const std::uint64_t capacity : {1, 2, 3, 5, 8}) {
        Frame frame;
        ASSERT_NO_THROW(frame = render(scene, options_with(capacity))) << "capacity " << capacity;
        EXPECT_EQ(frame.hash(), expected.hash()) << "capacity " << capacity;
        EXPECT_EQ(frame.rays.total(), expected.rays.total()) << "capacity " << capacity;
    }
}

TEST(every_camera_ray, is_counted_once_whatever_the_window) {
    Scene scene = all_glass(1);
    scene.settings.width = 37;
    scene.settings.height = 19;
    scene.settings.crop = {0.1, 0.93, 0.21, 0.8};
    const PixelWindow window = crop_window(scene.settings);
    const Frame frame = render(scene, options_with(100));
    EXPECT_EQ(frame.rays.camera, static_cast<std::uint64_t>(window.width * window.height * 3));
    for (std::size_t i = 0; i < frame.sums.size(); i += FILM_CHANNELS)
        ASSERT_EQ(frame.sums[i + 3], 3ll << FILM_FRACTION_BITS) << "pixel " << i / FILM_CHANNELS;  // three samples hit
}

}  // namespace
}  // namespace raymill
