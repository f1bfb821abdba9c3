#include "reference/formulas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "lib/random.h"
#include "scene_builder.hpp"

namespace raymill::reference {
namespace {

const dvec3 up(0, 0, 1);
constexpr double pi = glm::pi<double>();

/// Unit direction that falls on the xy plane at `angle` from its normal, along +x.
dvec3 falling(double angle) {
    return {std::sin(angle), 0, -std::cos(angle)};
}
/// Unit direction that leaves the plane at `angle`, along +x.
dvec3 rising(double angle) {
    return {std::sin(angle), 0, std::cos(angle)};
}

TEST(Reflect, mirrors_the_angle_about_the_normal) {
    for (const double angle : {0.0, 0.3, 1.0, 1.5}) expect_near(reflect(falling(angle), up), rising(angle), rounding);
}

TEST(Refract, follows_snell_in_the_plane_of_incidence) {
    for (const double eta : {1.5, 1 / 1.5, 1.33, 2.4}) {
        for (const double angle : {0.0, 0.1, 0.4, 0.7}) {
            const auto t = refract(falling(angle), up, eta);
            const double sine = std::sin(angle) / eta;  // n1 sin(1) = n2 sin(2)
            if (sine >= 1) continue;
            ASSERT_TRUE(t);
            expect_near(*t, {sine, 0, -std::sqrt(1 - sine * sine)}, rounding);
        }
    }
}

TEST(Refract, equal_indices_leave_every_direction_exactly_unchanged) {
    for (const double angle : {0.0, 0.2, 1.2, pi / 2}) {
        const auto t = refract(falling(angle), up, 1);
        ASSERT_TRUE(t);
        EXPECT_EQ(*t, falling(angle));
    }
}

TEST(Refract, a_perpendicular_ray_goes_straight_on) {
    EXPECT_EQ(*refract(-up, up, 1.7), -up);
}

TEST(Refract, nothing_passes_beyond_the_critical_angle) {
    const double eta = 1 / 1.5;
    const double critical = std::asin(eta);
    // 1e-7 radians off: the square root of the rounding that cos(2) amplifies there.
    const auto grazing = refract(falling(critical - 1e-7), up, eta);
    ASSERT_TRUE(grazing);
    EXPECT_NEAR(grazing->x, 1, 1e-6);  // sin(2) = 1 - O(1e-7)
    EXPECT_FALSE(refract(falling(critical + 1e-7), up, eta));
}

TEST(Fresnel, at_normal_incidence_is_the_squared_index_contrast) {
    for (const double n : {1.33, 1.5, 2.4, 1 / 1.5}) {
        EXPECT_NEAR(fresnel(1, n), (n - 1) * (n - 1) / ((n + 1) * (n + 1)), rounding);
    }
}

TEST(Fresnel, at_brewsters_angle_only_the_perpendicular_half_reflects) {
    for (const double n : {1.33, 1.5, 2.4}) {
        const double perpendicular = (1 - n * n) / (1 + n * n);  // r_s at tan(1) = n, where r_p = 0
        EXPECT_NEAR(fresnel(std::cos(std::atan(n)), n), perpendicular * perpendicular / 2, rounding);
    }
}

TEST(Fresnel, is_the_same_from_both_sides_of_the_boundary) {
    for (const double angle : {0.1, 0.6, 1.2}) {
        const double inner = std::asin(std::sin(angle) / 1.5);
        EXPECT_NEAR(fresnel(std::cos(angle), 1.5), fresnel(std::cos(inner), 1 / 1.5), rounding);
    }
}

TEST(Fresnel, is_total_at_grazing_and_beyond_the_critical_angle) {
    EXPECT_EQ(fresnel(0, 1.5), 1);
    EXPECT_EQ(fresnel(std::cos(std::asin(1 / 1.5) + 1e-6), 1 / 1.5), 1);
    EXPECT_LT(fresnel(std::cos(std::asin(1 / 1.5) - 1e-6), 1 / 1.5), 1);
}

TEST(Fresnel, equal_indices_never_reflect) {
    for (const double cosine : {0.0, 1e-12, 0.5, 1.0}) EXPECT_EQ(fresnel(cosine, 1), 0);
}

TEST(Highlight, phong_is_a_power_of_the_cosine_to_the_mirror_direction) {
    for (const double shininess : {1.0, 2.5, 100.0}) {
        // Light at 0.5 on +x, so its mirror at 0.5 on -x; the eye at 0.2 on -x: 0.3 apart.
        EXPECT_NEAR(phong_highlight(up, rising(0.5), rising(-0.2), shininess), std::pow(std::cos(0.3), shininess),
                    100 * rounding);  // the power multiplies the relative error by the exponent
    }
}

TEST(Highlight, blinn_is_a_power_of_the_cosine_to_the_half_vector) {
    for (const double shininess : {1.0, 2.5, 100.0}) {
        // Halfway between 0.5 and -0.2 lies 0.15.
        EXPECT_NEAR(blinn_highlight(up, rising(0.5), rising(-0.2), shininess), std::pow(std::cos(0.15), shininess),
                    100 * rounding);
    }
}

TEST(Highlight, shininess_zero_gives_exactly_one_even_where_the_cosine_is_not_positive) {
    EXPECT_EQ(phong_highlight(up, rising(0.5), rising(1.4), 0), 1);
    EXPECT_EQ(phong_highlight(up, rising(0.5), rising(0.1), 0), 1);
    EXPECT_EQ(blinn_highlight(up, up, -up, 0), 1);
}

TEST(Highlight, is_dark_across_from_the_mirror_direction) {
    EXPECT_EQ(phong_highlight(up, rising(1.2), rising(1.2), 1), 0);  // 2.4 apart: a negative cosine
    EXPECT_EQ(blinn_highlight(up, up, -up, 1), 0);
}

TEST(Attenuation, divides_by_the_polynomial_of_the_distance) {
    EXPECT_EQ(attenuation({1, 0, 0}, 7), 1);
    EXPECT_EQ(attenuation({0, 0, 1}, 2), 0.25);
    EXPECT_EQ(attenuation({1, 2, 3}, 2), 1.0 / 17);
    EXPECT_EQ(attenuation({0, 0, 1}, 0.5), 4);  // not clamped
}

TEST(Spot, is_full_inside_dark_outside_and_a_squared_ramp_between) {
    const double inner = std::cos(glm::radians(20.0));
    const double outer = std::cos(glm::radians(40.0));
    EXPECT_EQ(spot_factor(1, 20, 40), 1);
    EXPECT_EQ(spot_factor(inner + 1e-9, 20, 40), 1);
    EXPECT_EQ(spot_factor(outer - 1e-9, 20, 40), 0);
    for (const double share : {0.25, 0.5, 0.75}) {
        EXPECT_NEAR(spot_factor(glm::mix(outer, inner, share), 20, 40), share * share, rounding);
    }
}

TEST(Tangents, complete_every_normal_to_a_right_handed_frame) {
    std::vector<dvec3> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, glm::normalize(dvec3(1e-9, 0, -1))};
    for (int i = 0; i < 64; ++i) normals.push_back(uniform_sphere({(i + 0.5) / 64, std::fmod(i * 0.618, 1.0)}));
    for (const dvec3& n : normals) {
        const Tangents frame = tangents(n);
        EXPECT_NEAR(glm::length(frame.t), 1, rounding);
        EXPECT_NEAR(glm::dot(frame.t, n), 0, rounding);
        expect_near(glm::cross(frame.t, frame.u), n, rounding);
    }
}

TEST(ConcentricDisk, takes_squares_to_circles_and_keeps_areas) {
    EXPECT_EQ(concentric_disk({0.5, 0.5}), dvec2(0));
    EXPECT_NEAR(glm::distance(concentric_disk({1, 0.5}), dvec2(1, 0)), 0, rounding);
    EXPECT_NEAR(glm::distance(concentric_disk({0.5, 1}), dvec2(0, 1)), 0, rounding);
    EXPECT_NEAR(glm::distance(concentric_disk({0, 0.5}), dvec2(-1, 0)), 0, rounding);
    EXPECT_NEAR(glm::distance(concentric_disk({0.5, 0}), dvec2(0, -1)), 0, rounding);
    EXPECT_NEAR(glm::distance(concentric_disk({1, 1}), dvec2(std::sqrt(0.5))), 0, rounding);
    const double step = 1e-6;
    for (const dvec2 p : {dvec2(0.9, 0.6), dvec2(0.3, 0.1), dvec2(0.2, 0.7), dvec2(0.55, 0.8)}) {
        const dvec2 x = (concentric_disk(p + dvec2(step, 0)) - concentric_disk(p - dvec2(step, 0))) / (2 * step);
        const dvec2 y = (concentric_disk(p + dvec2(0, step)) - concentric_disk(p - dvec2(0, step))) / (2 * step);
        EXPECT_NEAR(x.x * y.y - x.y * y.x, pi, 1e-8);  // Jacobian; central differences err by step^2 and 1e-16/step
    }
}

TEST(UniformSphere, spreads_heights_evenly_over_the_unit_sphere) {
    for (const double a : {0.0, 0.25, 0.5, 0.9}) {
        const dvec3 p = uniform_sphere({a, 0.25});
        EXPECT_NEAR(glm::length(p), 1, rounding);
        EXPECT_NEAR(p.z, 1 - 2 * a, rounding);  // Archimedes: equal heights, equal areas
        EXPECT_NEAR(p.x, 0, rounding);          // a quarter turn
        EXPECT_GE(p.y, 0);
    }
}

// Niederreiter, "Low-Discrepancy and Low-Dispersion Sequences", 1988: the elementary intervals of a (0, 2)-sequence.
TEST(StratifiedSquare, holds_one_point_in_every_cell_of_every_grid_of_a_power_of_two) {
    for (const std::uint32_t log_count : {0u, 1u, 2u, 3u, 6u, 10u}) {
        const std::uint32_t count = 1u << log_count;
        for (const std::uint32_t first : {0u, 3 * count}) {
            for (std::uint32_t log_columns = 0; log_columns <= log_count; ++log_columns) {
                const std::uint32_t columns = 1u << log_columns, rows = count / columns;
                std::vector<int> in_cell(count);
                for (std::uint32_t i = first; i < first + count; ++i) {
                    const dvec2 p = stratified_square(i, 0x1234567u);
                    ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
                    ++in_cell[static_cast<std::size_t>(p.y * rows) * columns + static_cast<std::size_t>(p.x * columns)];
                }
                for (const int points : in_cell) EXPECT_EQ(points, 1);
            }
        }
    }
}

TEST(StratifiedSquare, differs_between_families) {
    int equal = 0;
    for (std::uint32_t key = 0; key < 1000; ++key) equal += stratified_square(0, key) == stratified_square(0, key + 1);
    EXPECT_EQ(equal, 0);
}

}  // namespace
}  // namespace raymill::reference
