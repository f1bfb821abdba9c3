#include <cmath>
#include <glm/gtc/constants.hpp>
#include <set>

#include "lib/random.h"
#include "reference/formulas.hpp"
#include "scene_builder.hpp"

namespace raymill::reference {
namespace {

constexpr double pi = glm::pi<double>();

/// Sample 0 of the only light seen from p.
template <typename Light>
LightSample seen_from(const Light& light, const dvec3& p, std::uint32_t samples = 1) {
    SceneBuilder b;
    b.add_light(light, samples);
    return Tracer(b.scene).sample_light(0, 0, p, 0, 0);
}

TEST(PointLightSample, falls_off_by_its_attenuation_and_is_divided_among_its_samples) {
    PointLight light;
    light.position = {0, 3, 0};
    light.intensity = {2, 4, 8};
    light.attenuation = {1, 1, 1};
    const LightSample s = seen_from(light, {0, 1, 0}, 4);
    EXPECT_EQ(s.direction, dvec3(0, 1, 0));
    EXPECT_EQ(s.distance, 2);
    EXPECT_EQ(s.shadow_distance, 2 * (1 - 1e-4));  // just before the lamp
    expect_near(s.incoming, dvec3(2, 4, 8) / 7.0 / 4.0, rounding);  // 1 + 2 + 4
}

TEST(PointLightSample, gives_nothing_at_its_own_place) {
    EXPECT_EQ(seen_from(PointLight{}, dvec3(0)).incoming, dvec3(0));
}

TEST(PointLightSample, a_ball_is_sampled_on_its_surface_one_in_each_stratum) {
    SceneBuilder b;
    PointLight light;
    light.position = {1, 2, 3};
    light.radius = 0.5f;
    light.attenuation = {0, 0, 1};
    b.add_light(light, 8);
    const Tracer tracer(b.scene);
    const dvec3 p(0, 0, 9);
    std::set<int> heights;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const LightSample s = tracer.sample_light(0, i, p, 0, 5);
        const dvec3 offset = p + s.distance * s.direction - dvec3(1, 2, 3);
        EXPECT_NEAR(glm::length(offset), 0.5, rounding * 10);
        // The sample is the light's position throughout: its own distance attenuates.
        EXPECT_NEAR(s.incoming.x, 1 / (s.distance * s.distance) / 8, rounding);
        heights.insert(static_cast<int>((1 - offset.z / 0.5) / 2 * 8 + 1e-6));  // z = 1 - 2a; 1e-6: 24 bits
    }
    EXPECT_EQ(heights.size(), 8u);
}

TEST(DirectionalLightSample, is_the_same_everywhere_and_comes_from_against_its_direction) {
    DirectionalLight light;
    light.direction = {0, -2, 0};
    light.intensity = glm::vec3(3);
    for (const dvec3 p : {dvec3(0), dvec3(1e6, -1e6, 0)}) {
        const LightSample s = seen_from(light, p);
        EXPECT_EQ(s.direction, dvec3(0, 1, 0));
        EXPECT_EQ(s.shadow_distance, INFINITY);
        EXPECT_EQ(s.incoming, dvec3(3));
    }
}

TEST(SpotLightSample, multiplies_attenuation_and_cone) {
    SpotLight light;
    light.position = {0, 4, 0};
    light.direction = {0, -3, 0};
    light.attenuation = {0, 0, 1};
    light.inner_angle = 30;
    light.outer_angle = 60;
    EXPECT_NEAR(seen_from(light, {0, 0, 0}).incoming.x, 1.0 / 16, rounding);
    // At 45 degrees: ((cos 45 - cos 60) / (cos 30 - cos 60))^2, at distance 4 sqrt 2.
    const double ramp = (std::sqrt(0.5) - 0.5) / (std::sqrt(0.75) - 0.5);
    EXPECT_NEAR(seen_from(light, {4, 0, 0}).incoming.x, ramp * ramp / 32, rounding);
    EXPECT_EQ(seen_from(light, {0, 0, 8}).incoming, dvec3(0));  // 63 degrees
    EXPECT_EQ(seen_from(light, {0, 5, 0}).incoming, dvec3(0));  // behind
}

TEST(LightSampleNumber, counts_through_the_camera_samples_in_a_family_of_its_own_path_and_light) {
    SceneBuilder b;
    RectangleLight light;
    light.edge_v = {0, 0, 1};
    b.add_light(AmbientLight{});
    b.add_light(light, 3);
    b.scene.settings.spp = 2;
    const LightSample s = Tracer(b.scene).sample_light(1, 2, {0, -2, 0}, 1, 77);
    const dvec3 on_light = dvec3(0, -2, 0) + s.distance * s.direction;
    // Light sample 2 of camera sample 1: number 1 * 3 + 2 of 2 * 3; the edges are those of the unit square.
    const dvec2 ab = stratified_square(5, random_key(77, RANDOM_LIGHT + 1));
    expect_near(on_light, {ab.x - 0.5, 0, ab.y - 0.5}, rounding);
}

TEST(AreaLightSample, gives_nothing_behind_a_rectangle_or_disk_or_inside_a_sphere) {
    EXPECT_EQ(seen_from(RectangleLight{}, {0, -1, 0}).incoming, dvec3(0));  // default: x cross -z shines to +y
    EXPECT_GT(seen_from(RectangleLight{}, {0, 1, 0}).incoming.x, 0);
    EXPECT_EQ(seen_from(DiskLight{}, {0, 1, 0}).incoming, dvec3(0));
    EXPECT_GT(seen_from(DiskLight{}, {0, -1, 0}).incoming.x, 0);
    EXPECT_EQ(seen_from(SphereLight{}, {0, 0.5, 0}).incoming, dvec3(0));
}

TEST(AreaLightSample, lies_on_the_light_and_its_shadow_segment_ends_just_before) {
    SceneBuilder b;
    RectangleLight rectangle;
    rectangle.edge_u = {2, 0, 0};
    DiskLight disk;
    disk.normal = {0, 1, 0};
    b.add_light(rectangle, 16);
    b.add_light(disk, 16);
    b.add_light(SphereLight{}, 16);
    const Tracer tracer(b.scene);
    const dvec3 p(0.5, 2, 0.25);
    for (std::uint32_t i = 0; i < 16; ++i) {
        const auto point = [&](std::uint32_t light) {
            const LightSample s = tracer.sample_light(light, i, p, 0, 3);
            EXPECT_NEAR(s.shadow_distance, s.distance * (1 - 1e-4), rounding);
            return p + s.distance * s.direction;
        };
        const dvec3 on_rectangle = point(0);
        EXPECT_NEAR(on_rectangle.y, 0, rounding);
        EXPECT_TRUE(std::abs(on_rectangle.x) <= 1 && std::abs(on_rectangle.z) <= 0.5);
        const dvec3 on_disk = point(1);
        EXPECT_NEAR(on_disk.y, 0, rounding);
        EXPECT_LE(glm::length(on_disk), 1);
        const dvec3 on_sphere = point(2);
        EXPECT_NEAR(glm::length(on_sphere), 1, 1e-12);  // the square root amplifies rounding at the silhouette
        EXPECT_GE(glm::dot(on_sphere, p), 1 - 1e-12);   // the near side: within the cap seen from p
    }
}

/// Mean and standard error of I_in cos(theta) over independent stratified runs: k_d F L of a white Lambert surface.
struct Estimate {
    double mean;
    double error;
};

template <typename Light>
Estimate irradiance(const Light& light, const dvec3& p, const dvec3& n) {
    constexpr int runs = 64;
    constexpr int samples = 64;
    SceneBuilder b;
    b.add_light(light, samples);
    const Tracer tracer(b.scene);
    double sum = 0, squares = 0;
    for (std::uint32_t path = 0; path < runs; ++path) {
        double run = 0;
        for (std::uint32_t i = 0; i < samples; ++i) {
            const LightSample s = tracer.sample_light(0, i, p, 0, path);
            run += s.incoming.x * std::max(0.0, glm::dot(n, s.direction));
        }
        sum += run;
        squares += run * run;
    }
    const double mean = sum / runs;
    return {mean, std::sqrt((squares / runs - mean * mean) / (runs - 1))};
}

TEST(FormFactor, of_a_parallel_rectangle_is_that_of_its_four_quarters) {
    RectangleLight light;
    light.center = {0, 2, 0};
    light.edge_u = {0, 0, 2};
    light.edge_v = {4, 0, 0};
    light.edge_u = -light.edge_u;  // -z cross x = -y: shines down
    light.radiance = glm::vec3(1);
    // Corner rectangle a x b at height h, X = a/h, Y = b/h (Howell's catalogue, B-4):
    // F = [X/sqrt(1+X^2) atan(Y/sqrt(1+X^2)) + Y/sqrt(1+Y^2) atan(X/sqrt(1+Y^2))] / (2 pi).
    const double x = 0.5, y = 1;
    const double sx = std::sqrt(1 + x * x), sy = std::sqrt(1 + y * y);
    const double quarter = (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * pi);
    const Estimate e = irradiance(light, dvec3(0), {0, 1, 0});
    EXPECT_NEAR(e.mean, 4 * quarter, 4 * e.error);  // four standard errors
    EXPECT_LT(e.error, 1e-3 * e.mean);              // and the test is sharp
}

TEST(FormFactor, of_a_coaxial_disk_is_r2_over_r2_plus_h2) {
    DiskLight light;
    light.center = {0, 2, 0};
    light.radius = 1.5f;
    const Estimate e = irradiance(light, dvec3(0), {0, 1, 0});
    EXPECT_NEAR(e.mean, 2.25 / (2.25 + 4), 4 * e.error);  // Howell's catalogue, B-12
    EXPECT_LT(e.error, 1e-3 * e.mean);
}

TEST(FormFactor, of_a_sphere_is_r2_over_d2_times_the_cosine) {
    SphereLight light;
    light.center = {3, 4, 0};
    light.radius = 2;
    const Estimate e = irradiance(light, dvec3(0), {0, 1, 0});
    EXPECT_NEAR(e.mean, 4.0 / 25 * 0.8, 4 * e.error);  // wholly above the horizon: Howell's catalogue, B-37
    EXPECT_LT(e.error, 1e-2 * e.mean);
}

TEST(FormFactor, of_a_sphere_stays_exact_from_far_away) {
    SphereLight light;
    light.center = {0, 1e6f, 0};
    light.radius = 1;
    // The cosine varies by 1e-12 over the cap; 1 - cos would have lost it all.
    EXPECT_NEAR(seen_from(light, dvec3(0)).incoming.x / 1e-12, 1, 1e-11);
}

TEST(AmbientAndEnvironment, cast_no_light_samples) {
    EXPECT_EQ(seen_from(AmbientLight{}, dvec3(0)).incoming, dvec3(0));
    EXPECT_EQ(seen_from(EnvironmentLight{}, dvec3(0)).incoming, dvec3(0));
}

TEST(Background, is_the_sum_of_background_and_constant_environment) {
    SceneBuilder b;
    b.scene.settings.background = {1, 2, 3};
    EnvironmentLight light;
    light.radiance = glm::vec3(4);
    b.add_light(light);
    EXPECT_EQ(Tracer(b.scene).background({0, 0, 1}), dvec3(5, 6, 7));
}

TEST(Background, a_lat_long_map_has_its_top_up_and_its_middle_at_plus_z) {
    SceneBuilder b;
    TextureImage image;
    image.width = 4;
    image.height = 2;
    for (int i = 0; i < 8; ++i) image.texels.emplace_back(static_cast<float>(i));
    b.scene.images.push_back(image);
    EnvironmentLight light;
    light.map = 0;
    light.radiance = glm::vec3(2);
    b.add_light(light);
    const Tracer tracer(b.scene);
    // Texel centres: columns at longitudes 135, 45, -45, -135 degrees from +z towards +x; rows at latitudes +-45.
    const double half = std::sqrt(0.5);
    EXPECT_NEAR(tracer.background({0.5, half, 0.5}).x, 2 * 1, rounding);
    EXPECT_NEAR(tracer.background({0.5, half, -0.5}).x, 2 * 0, rounding);
    EXPECT_NEAR(tracer.background({-0.5, half, 0.5}).x, 2 * 2, rounding);
    EXPECT_NEAR(tracer.background({-0.5, -half, -0.5}).x, 2 * 7, rounding);
    EXPECT_NEAR(tracer.background({0, -half, half}).x, 2 * 5.5, rounding);   // between columns 1 and 2
    EXPECT_NEAR(tracer.background({0, -half, -half}).x, 2 * 5.5, rounding);  // around: between columns 3 and 0
    EXPECT_NEAR(tracer.background({0, 1, 0}).x, tracer.background({0, std::cos(0.1), std::sin(0.1)}).x, rounding);
}

}  // namespace
}  // namespace raymill::reference
