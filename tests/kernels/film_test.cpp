// What the film adds, leaves out and counts, and what resolve makes of its integers.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "kernel_rig.hpp"
#include "queues.hpp"
#include "random.hpp"

namespace raymill::test {
namespace {

constexpr float LARGEST = 16777216.0f;  // FILM_LIMIT

Scene nothing_but_background() {
    Scene scene;
    scene.materials.emplace_back();
    scene.settings.background = {1, 0.5, -2};
    return scene;
}

/// A ray that misses, of the given red weight.
Ray weighing(float red, uint pixel) {
    Ray ray = make_ray({0, 0, 0}, {0, 0, 1}, pixel);
    store(ray.throughput, {red, 0, 0});
    return ray;
}

TEST(Film, a_ray_that_misses_adds_its_weight_times_the_background_exactly) {
    Random random(1);
    std::vector<Ray> rays;
    for (uint i = 0; i < 1000; ++i) {
        rays.push_back(make_ray(random.in_cube(-1, 1), random.direction(), i / 4));
        store(rays.back().throughput, std::exp2(random.in(-30, 10)) * random.in_cube(0, 1));
    }
    const IntersectResult result = KernelRig(nothing_but_background()).intersect(rays);
    std::vector<std::int64_t> expected(251 * FILM_CHANNELS, 0);
    const float background[] = {1, 0.5f, -2};
    for (uint i = 0; i < 1000; ++i)
        for (uint k = 0; k < 3; ++k)
            expected[i / 4 * FILM_CHANNELS + k] += film_units(rays[i].throughput[k] * background[k]);
    EXPECT_EQ(result.film.sums, expected);
    EXPECT_EQ(result.film.counters.saturated + result.film.counters.not_a_number, 0u);
}

TEST(Film, only_camera_rays_that_hit_count_as_coverage) {
    Scene scene = nothing_but_background();
    add_sphere(scene, {0, 0, 5}, 1);
    std::vector<Ray> rays;
    for (uint route : {ROUTE_CAMERA, ROUTE_REFLECTED, ROUTE_REFRACTED})
        for (const float z : {1.0f, -1.0f}) {
            rays.push_back(make_ray({0, 0, 0}, {0, 0, z}, static_cast<uint>(rays.size())));
            rays.back().route = route;
        }
    const KernelRig rig(scene);
    const IntersectResult found = rig.intersect(rays);
    const FilmState shaded = rig.shade(rays, std::span(found.hits).first(rays.size()), 0, 0).film;
    for (uint i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(found.film.at(i, 0), i % 2 == 0 ? 0 : film_units(1)) << i;
        EXPECT_EQ(found.film.at(i, 3), 0) << i;
        EXPECT_EQ(shaded.at(i, 3), i == 0 ? FILM_ONE : 0) << i;
    }
}

TEST(Film, coverage_counts_the_hits_of_a_pixel_s_samples) {
    Scene scene = nothing_but_background();
    add_sphere(scene, {0, 0, 5}, 1);
    Random random(4);
    std::vector<Ray> rays;
    std::vector<std::int64_t> expected(21, 0), missing(21, 0);
    for (const uint samples : {3u, 1u, 70u, 16u, 40u, 2u}) {
        const uint pixel = random.below(20);
        for (uint i = 0; i < samples; ++i) {
            const bool hits = random.below(3) > 0;
            rays.push_back(make_ray({0, 0, 0}, {0, 0, hits ? 1.0f : -1.0f}, pixel));
            (hits ? expected : missing)[pixel] += FILM_ONE;
        }
    }
    rays.push_back(make_ray({0, 0, 0}, {0, 0, -1}, 20));
    missing[20] = FILM_ONE;
    const KernelRig rig(scene);
    const IntersectResult found = rig.intersect(rays);
    const FilmState film = rig.shade(rays, std::span(found.hits).first(rays.size()), 0, 0).film;
    for (uint pixel = 0; pixel < expected.size(); ++pixel) {
        EXPECT_EQ(film.at(pixel, 3), expected[pixel]) << pixel;
        EXPECT_EQ(found.film.at(pixel, 0), missing[pixel]) << pixel;  // of a background of 1
    }
}

TEST(Film, plain_adds_count_the_coverage_of_atomic_ones) {
    Scene scene = nothing_but_background();
    scene.settings.background = {0, 0, 0};
    scene.lights.push_back({AmbientLight{{0.5f, 0.25f, 0.125f}}});
    add_sphere(scene, {0, 0, 5}, 1);
    std::vector<Ray> rays;
    for (uint i = 0; i < 150; ++i) {
        rays.push_back(make_ray({0, 0, 0}, {0, 0, i % 7 == 0 ? -1.0f : 1.0f}, i));
        rays.back().route = i % 5 == 0 ? ROUTE_REFLECTED : ROUTE_CAMERA;
    }
    const KernelRig rig(scene);
    const IntersectResult found = rig.intersect(rays);
    const std::span hits = std::span(found.hits).first(rays.size());
    const FilmState atomic = rig.shade(rays, hits, 0, 0).film, plain = rig.shade(rays, hits, 0, 0, 0, true).film;
    EXPECT_EQ(plain.sums, atomic.sums);
    for (uint i = 0; i < rays.size(); ++i) EXPECT_EQ(plain.at(i, 3), i % 7 == 0 || i % 5 == 0 ? 0 : FILM_ONE) << i;
}

TEST(Film, what_is_not_a_number_is_left_out_and_counted) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Ray> rays = {weighing(nan, 0), weighing(1, 0), weighing(nan, 1)};
    const IntersectResult result = KernelRig(nothing_but_background()).intersect(rays);
    EXPECT_EQ(result.film.at(0, 0), film_units(1));
    EXPECT_EQ(result.film.at(1, 0), 0);
    EXPECT_EQ(result.film.counters.not_a_number, 2u);
    EXPECT_EQ(result.film.counters.saturated, 0u);
}

TEST(Film, what_is_too_bright_is_cut_and_counted) {
    const std::vector<Ray> rays = {weighing(LARGEST, 0), weighing(2 * LARGEST, 1), weighing(-2 * LARGEST, 2),
                                   weighing(INFINITY, 3), weighing(3e38f, 4)};
    const IntersectResult result = KernelRig(nothing_but_background()).intersect(rays);
    for (const uint pixel : {0u, 1u, 3u, 4u}) EXPECT_EQ(result.film.at(pixel, 0), film_units(LARGEST)) << pixel;
    EXPECT_EQ(result.film.at(2, 0), film_units(-LARGEST));
    EXPECT_EQ(result.film.counters.saturated, 4u);
    // Infinity's other channels are infinity times the weight 0 of the background's green and blue: 0.
    EXPECT_EQ(result.film.counters.not_a_number, 0u);
}

TEST(Film, sums_that_overflow_are_counted) {
    // 2^24 fits 127 times into 2^31, and 64-bit sums end at 2^31.
    const std::vector<Ray> rays(128, weighing(LARGEST, 0));
    const KernelRig rig(nothing_but_background());
    EXPECT_EQ(rig.intersect(std::span(rays).first(127)).film.counters.saturated, 0u);
    EXPECT_EQ(rig.intersect(rays).film.counters.saturated, 1u);
}

TEST(Film, plain_adds_make_the_sums_and_counts_of_atomic_ones) {
    Random random(3);
    std::vector<Ray> rays;
    for (uint i = 0; i < 4 * CHUNK; ++i) {
        rays.push_back(weighing(std::exp2(random.in(-40, 26)) * (random.below(2) == 0 ? 1.0f : -1.0f), i));
        if (random.below(50) == 0) rays.back().throughput[0] = std::numeric_limits<float>::quiet_NaN();
    }
    const KernelRig rig(nothing_but_background());
    const FilmState atomic = rig.intersect(rays).film, plain = rig.intersect(rays, 0, true).film;
    EXPECT_GT(atomic.counters.not_a_number, 0u);
    EXPECT_GT(atomic.counters.saturated, 0u);
    EXPECT_EQ(plain.sums, atomic.sums);
    EXPECT_TRUE(same_bits(plain.counters, atomic.counters));
}

TEST(Film, plain_sums_that_overflow_are_counted_each) {
    std::vector<Ray> rays;
    for (uint i = 0; i < 20; ++i) rays.push_back(weighing(i == 2 || i == 7 || i == 17 ? LARGEST : 1, i));
    const KernelRig rig(nothing_but_background());
    EXPECT_EQ(rig.intersect(rays, 0, true, 127).film.counters.saturated, 0u);
    EXPECT_EQ(rig.intersect(rays, 0, true, 128).film.counters.saturated, 3u);
}

TEST(Film, negative_light_subtracts) {
    const std::vector<Ray> rays = {weighing(-0.375f, 0), weighing(0.125f, 0)};
    EXPECT_EQ(KernelRig(nothing_but_background()).intersect(rays).film.at(0, 0), film_units(-0.25f));
}

TEST(Film, light_below_half_its_unit_adds_nothing) {
    const std::vector<Ray> rays = {weighing(0x1p-34f, 0), weighing(0x1p-32f, 1), weighing(0x1.8p-32f, 2)};
    const IntersectResult result = KernelRig(nothing_but_background()).intersect(rays);
    EXPECT_EQ(result.film.at(0, 0), 0);
    EXPECT_EQ(result.film.at(1, 0), 1);
    EXPECT_EQ(result.film.at(2, 0), 2);  // ties to even
}

TEST(Resolve, divides_each_sum_by_the_samples_of_a_pixel) {
    Random random(2);
    for (const std::size_t count : {1u, 63u, 64u, 65u, 4096u})
        for (const uint spp : {1u, 3u, 7u, 64u}) {
            std::vector<std::int64_t> sums;
            for (std::size_t i = 0; i < count; ++i) {
                const auto high = static_cast<std::int64_t>(random.bits()) << 32;
                sums.push_back((high | random.bits()) >> random.below(63));
            }
            const std::vector<float> pixels = resolve_on_device(sums, spp);
            for (std::size_t i = 0; i < count; ++i) {
                // Exact but for the conversion, to the nearest, and the quotient.
                const float expected = static_cast<float>(sums[i]) * 0x1p-32f / static_cast<float>(spp);
                ASSERT_EQ(pixels[i], expected) << sums[i];
            }
            EXPECT_EQ(touched_from(pixels, count), 0u);
        }
}

}  // namespace
}  // namespace raymill::test
