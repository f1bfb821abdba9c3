#include <cmath>
#include <set>

#include "lib/random.h"
#include "reference/formulas.hpp"
#include "scene_builder.hpp"

namespace raymill::reference {
namespace {

/// Eye at (0, 0, 5) looking down -z at the origin: x right, y up.
SceneBuilder frontal(int width, int height) {
    SceneBuilder b;
    b.scene.settings.width = width;
    b.scene.settings.height = height;
    b.scene.camera.eye = {0, 0, 5};
    b.scene.camera.look_at = {0, 0, 0};
    b.scene.camera.fov = 90;
    return b;
}

TEST(CameraRay, one_sample_goes_through_the_pixels_centre_with_the_vertical_field_of_view) {
    const SceneBuilder b = frontal(4, 2);
    const Tracer tracer(b.scene);
    // tan(45 degrees) = 1: the film at unit distance spans [-2, 2] x [-1, 1]; pixel (0, 0) is top left.
    expect_near(tracer.camera_ray(0, 0, 0).direction, glm::normalize(dvec3(-1.5, 0.5, -1)), rounding);
    expect_near(tracer.camera_ray(3, 1, 0).direction, glm::normalize(dvec3(1.5, -0.5, -1)), rounding);
    EXPECT_EQ(tracer.camera_ray(3, 1, 0).origin, dvec3(0, 0, 5));
}

TEST(CameraRay, the_view_is_upright_for_a_camera_that_looks_down_a_slope) {
    SceneBuilder b = frontal(1, 3);
    b.scene.camera.eye = {1, 2, 3};
    b.scene.camera.look_at = {4, 0, 3};
    const Tracer tracer(b.scene);
    expect_near(tracer.camera_ray(0, 1, 0).direction, glm::normalize(dvec3(3, -2, 0)), rounding);
    EXPECT_GT(tracer.camera_ray(0, 0, 0).direction.y, tracer.camera_ray(0, 1, 0).direction.y);
    EXPECT_NEAR(tracer.camera_ray(0, 0, 0).direction.z, 0, rounding);
}

TEST(CameraRay, many_samples_of_a_pixel_lie_one_in_each_stratum) {
    SceneBuilder b = frontal(4, 4);
    b.scene.settings.spp = 16;
    const Tracer tracer(b.scene);
    std::set<int> columns, rows, cells;
    for (std::uint32_t sample = 0; sample < 16; ++sample) {
        const dvec3 d = tracer.camera_ray(2, 1, sample).direction;
        const dvec2 film(d.x / -d.z, d.y / -d.z);
        // In the pixel: x in [0, 0.5), y in (0, 0.5] on the film. 1e-7 covers the 24 bits of the point.
        const double fx = film.x * 2 + 1e-7;
        const double fy = 1 - film.y * 2 + 1e-7;
        ASSERT_TRUE(fx >= 0 && fx < 1 && fy >= 0 && fy < 1);
        columns.insert(static_cast<int>(fx * 16));
        rows.insert(static_cast<int>(fy * 16));
        cells.insert(static_cast<int>(fx * 4) + 4 * static_cast<int>(fy * 4));
    }
    EXPECT_EQ(columns.size(), 16u);
    EXPECT_EQ(rows.size(), 16u);
    EXPECT_EQ(cells.size(), 16u);
}

TEST(CameraRay, orthographic_rays_are_parallel_and_a_full_height_apart) {
    SceneBuilder b = frontal(2, 4);
    b.scene.camera.projection = Projection::orthographic;
    b.scene.camera.height = 8;
    const Tracer tracer(b.scene);
    for (int y = 0; y < 4; ++y) {
        const Ray ray = tracer.camera_ray(1, y, 0);
        expect_near(ray.direction, {0, 0, -1}, rounding);
        expect_near(ray.origin, {1, 3 - 2 * y, 5}, rounding);  // rows 8 / 4 apart, columns 4 / 2
    }
}

TEST(CameraRay, all_rays_of_a_lens_meet_in_the_plane_in_focus_and_start_on_the_lens) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        SceneBuilder b = frontal(3, 3);
        b.scene.camera.projection = projection;
        b.scene.camera.aperture = 0.5;
        b.scene.camera.focus = 3;
        b.scene.settings.spp = 16;
        Scene pinhole = b.scene;
        pinhole.camera.aperture = 0;
        const Tracer sharp(pinhole), tracer(b.scene);
        bool off_centre = false;
        for (std::uint32_t sample = 0; sample < 16; ++sample) {
            const Ray through_pinhole = sharp.camera_ray(2, 0, sample);
            const Ray ray = tracer.camera_ray(2, 0, sample);
            const auto at_focus = [](const Ray& r) { return r.origin + 3 / -r.direction.z * r.direction; };
            expect_near(at_focus(ray), at_focus(through_pinhole), rounding * 10);  // coordinates up to 5
            const dvec3 on_lens = ray.origin - through_pinhole.origin;
            const std::uint32_t key = random_key(path_camera(0, 2), RANDOM_LENS);  // pixel (2, 0)
            const dvec2 disk = 0.25 * concentric_disk(stratified_square(sample, key));
            expect_near(on_lens, {disk.x, disk.y, 0}, rounding);
            EXPECT_LE(glm::length(on_lens), 0.25 + rounding);
            off_centre = off_centre || glm::length(on_lens) > 0.125;
        }
        EXPECT_TRUE(off_centre);
    }
}

TEST(CameraRay, without_a_focus_the_lens_is_sharp_at_the_point_looked_at) {
    SceneBuilder b = frontal(1, 1);
    b.scene.camera.aperture = 1;
    const Ray ray = Tracer(b.scene).camera_ray(0, 0, 0);
    ASSERT_GT(glm::length(ray.origin - b.scene.camera.eye), 0);
    expect_near(ray.origin - ray.origin.z / ray.direction.z * ray.direction, dvec3(0), rounding * 10);
}

TEST(Pixel, averages_its_samples_and_counts_those_that_hit) {
    SceneBuilder b = frontal(1, 1);
    b.scene.settings.spp = 16;
    b.scene.settings.background = {0, 0, 8};
    // Fills the left half of the film: [-1, 0] x [-1, 1] at unit distance.
    b.add_quad({-9, -9, 4}, {0, -9, 4}, {0, 9, 4}, {-9, 9, 4}, b.add_material(emitter({2, 0, 0})));
    // 16 points, one a column of the finest grid: exactly half of them lie left.
    const glm::dvec4 pixel = Tracer(b.scene).pixel(0, 0);
    EXPECT_EQ(pixel, glm::dvec4(1, 0, 4, 0.5));
}

}  // namespace
}  // namespace raymill::reference
