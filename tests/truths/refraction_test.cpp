// Where refraction sends a ray: slabs, water, balls, prisms, one medium in another.
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

constexpr double pi = glm::pi<double>();

/// Angle in the second medium; Snell 1621.
double snell(double angle, double n1, double n2) {
    return std::asin(std::sin(angle) * n1 / n2);
}

/// A slab 0 > y > -thickness in air, and a ruler below it that reads x / 16 and z / 16 + 1/2.
Scene slab_above_ruler(double thickness, double ruler_y, double ior) {
    SceneBuilder b;
    const std::uint32_t glass = b.add_material(clear(ior));
    b.add_plane({0, 0, 0}, {0, 1, 0}, glass);
    b.add_plane({0, -thickness, 0}, {0, -1, 0}, glass);
    add_ruler(b, {0, ruler_y, 8}, {16, 0, 0}, {0, 0, -16});  // faces up: x cross -z
    return b.scene;
}

/// x where the ray that meets the origin at this angle to -y ends on the ruler. Nothing of its light is lost.
double landing_x(Probe& probe, double angle, double unit = 16) {
    const dvec3 d(std::sin(angle), -std::cos(angle), 0);
    const dvec3 seen = probe.look(-1.0 * d, d);
    EXPECT_NEAR(seen.z, 1, hit_roundings);
    EXPECT_NEAR(seen.y / seen.z, 0.5, hit_roundings);  // stays in its plane
    return unit * reading(seen).x;
}

/// Error of such a landing point: a hit's roundings on each of three surfaces over lengths of at most `extent`, larger
/// by the slope at which an angle's error becomes a length, 1 / cos^2.
double landing_bound(double angle, double extent) {
    return 3 * hit_roundings * extent / (std::cos(angle) * std::cos(angle));
}

class SlabAt : public testing::TestWithParam<int> {};

TEST_P(SlabAt, shifts_the_ray_sideways_and_leaves_its_direction) {
    const double angle = degrees(GetParam()), thickness = 0.5, n = 1.5;
    Probe near(slab_above_ruler(thickness, -0.5625, n)), far(slab_above_ruler(thickness, -1.5625, n));
    const double x1 = landing_x(near, angle), x2 = landing_x(far, angle);
    // Pedrotti, Introduction to Optics: shift across the ray s = t sin(i) (1 - cos(i) / sqrt(n^2 - sin^2(i))).
    const double s = std::sin(angle), c = std::cos(angle);
    const double shift = thickness * s * (1 - c / std::sqrt(n * n - s * s));
    const double bound = landing_bound(angle, 2);
    EXPECT_NEAR((0.5625 * std::tan(angle) - x1) * c, shift, bound * c);
    EXPECT_NEAR(std::atan(x2 - x1), angle, 2 * bound * c * c);  // d atan(x) = cos^2 dx
}

INSTANTIATE_TEST_SUITE_P(Degrees, SlabAt, testing::Values(30, 40, 50, 60, 70, 80));

TEST(ApparentDepth, of_a_pool_is_its_depth_over_the_index_from_straight_above) {
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(clear(1.33)));
    add_ruler(b, {0, -2, 8}, {16, 0, 0}, {0, 0, -16});
    Probe probe(b.scene);
    for (const double angle : {degrees(2), degrees(45)}) {
        // Where the ray seems to come from: x / tan(i) deep, x = h tan(r). For small i that is h / n, up to i^2.
        const double depth = landing_x(probe, angle) / std::tan(angle);
        const double bound = landing_bound(angle, 2) / std::tan(angle);
        EXPECT_NEAR(depth, 2 * std::tan(snell(angle, 1, 1.33)) / std::tan(angle), bound);
        if (angle < 0.1) {
            EXPECT_NEAR(depth, 2 / 1.33, 2 * angle * angle + bound);
        }
    }
}

TEST(BallLens, sends_rays_through_the_points_that_snell_says_and_near_ones_through_the_focus) {
    const double n = 1.5, radius = 1;
    // Paraxially the focus lies n R / (2 (n - 1)) = 1.5 from the centre.
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, static_cast<float>(radius), b.add_material(clear(n)));
    add_ruler(b, {-0.5f, -0.5f, 1.5f}, {0, 1, 0}, {1, 0, 0});  // x reads the height y; faces -z: y cross x
    Probe probe(b.scene);
    for (const double y : {0.001, 0.01, 0.1, 0.3, 0.6}) {
        SCOPED_TRACE(y);
        const dvec3 seen = probe.look({0, y, -3}, {0, y, 0});
        const double height = reading(seen).x - 0.5;
        // The ray turns by 2 (i - r) and leaves as far from the centre as it came: h = (y - z sin(turn)) / cos(turn).
        const double turn = 2 * (std::asin(y / radius) - std::asin(y / radius / n));
        const double bound = 3 * hit_roundings * 3 / std::cos(turn);  // three surfaces, 3 units apart at most
        EXPECT_NEAR(height, (y - 1.5 * std::sin(turn)) / std::cos(turn), bound);
        if (y < 0.05) {
            EXPECT_NEAR(height, 0, y * y * y + bound);  // spherical aberration is of third order
        }
    }
}

TEST(Prism, deviates_by_the_angle_that_its_index_asks_for_and_least_when_symmetric) {
    const double apex = degrees(60), n = 1.5;
    SceneBuilder b;
    const std::uint32_t glass = b.add_material(clear(n));
    // Faces through the edge at (0, 1): normals at 150 and 30 degrees, the glass below.
    const dvec3 left(-std::cos(apex / 2), std::sin(apex / 2), 0), right(-left.x, left.y, 0);
    b.add_plane({0, 1, 0}, left, glass);
    b.add_plane({0, 1, 0}, right, glass);
    Scene scenes[2];
    for (const int i : {0, 1}) {
        SceneBuilder with_ruler = b;
        add_ruler(with_ruler, {2.0f + static_cast<float>(i), -8, -8}, {0, 16, 0}, {0, 0, 16});
        with_ruler.scene.lights[0] = {};
        with_ruler.scene.lights[0].light = directional_light({1, 0, 0});
        scenes[i] = with_ruler.scene;
    }
    Probe near(scenes[0]), far(scenes[1]);
    double least = pi, at_symmetry = 0;
    for (const double incidence : {40.0, 45.0, 48.590378, 52.0, 60.0}) {
        SCOPED_TRACE(incidence);
        const double i1 = degrees(incidence);
        // Towards the left face at this angle to its normal, from below, through its middle.
        const double heading = degrees(-30) + i1;
        const dvec3 d(std::cos(heading), std::sin(heading), 0);
        const dvec3 middle = dvec3(0, 1, 0) + 0.5 * dvec3(-std::sin(apex / 2), -std::cos(apex / 2), 0);
        const auto height = [&](Probe& probe) { return 16 * reading(probe.look(middle - d, middle)).x - 8; };
        const double exit = std::atan(height(far) - height(near));
        // Born and Wolf 4.7: D = i1 + i2 - A with sin(i1) = n sin(r1), r1 + r2 = A, n sin(r2) = sin(i2).
        const double i2 = snell(apex - snell(i1, 1, n), n, 1);
        const double deviation = heading - exit;
        // Two readings on a ruler of 16 units; leaving steepens an angle's error by n cos(r) / cos(i) < 4.
        const double bound = 2 * 4 * 16 * hit_roundings;
        EXPECT_NEAR(deviation, i1 + i2 - apex, bound);
        least = std::min(least, deviation);
        if (incidence == 48.590378) at_symmetry = deviation;
    }
    EXPECT_EQ(at_symmetry, least);
    // n = sin((A + D) / 2) / sin(A / 2)
    EXPECT_NEAR(at_symmetry, 2 * std::asin(n * std::sin(apex / 2)) - apex, 2 * 4 * 16 * hit_roundings);
}

TEST(NestedDielectrics, a_wall_between_water_and_glass_is_one_material_with_two_indices) {
    const double water = 1.33, glass = 1.5;
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(clear(water)));
    b.add_plane({0, -1, 0}, {0, 1, 0}, b.add_material(clear(glass, water)));
    add_ruler(b, {0, -2, 8}, {16, 0, 0}, {0, 0, -16});
    Probe probe(b.scene);
    for (const double angle : {degrees(30), degrees(60), degrees(80)}) {
        // n sin(theta) is the same in all layers; one unit of each.
        const double expected = std::tan(snell(angle, 1, water)) + std::tan(snell(angle, 1, glass));
        EXPECT_NEAR(landing_x(probe, angle), expected, landing_bound(angle, 2));
    }
}

TEST(NestedDielectrics, a_glass_ball_in_water_bends_by_the_ratio_of_the_indices) {
    const double water = 1.33, glass = 1.5;
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, b.add_material(clear(glass, water)));
    add_ruler(b, {-0.5f, -0.5f, 2}, {0, 1, 0}, {1, 0, 0});
    Probe probe(b.scene);
    const double y = 0.4;  // the eye is in the water too
    const double turn = 2 * (std::asin(y) - std::asin(y * water / glass));
    EXPECT_NEAR(reading(probe.look({0, y, -3}, {0, y, 0})).x - 0.5, (y - 2 * std::sin(turn)) / std::cos(turn),
                3 * hit_roundings * 3);
}

TEST(EqualIndices, make_a_thing_invisible) {
    for (const double ior : {1.0, 1.33}) {
        SceneBuilder empty;
        add_ruler(empty, {-2, -2, 2}, {0, 4, 0}, {4, 0, 0});
        SceneBuilder filled = empty;
        filled.add_sphere({0, 0, 0}, 1, filled.add_material(clear(ior, ior)));
        Probe without(empty.scene), with(filled.scene);
        for (const double x : {0.0, 0.3, 0.7, 0.99}) {
            const dvec3 eye(0.1, 0.2, -3), target(x, 0, 0);
            EXPECT_EQ(with.look(eye, target).z, 1);
            // The direction does not change by a bit; the two restarts are off by a hit's roundings each, over 4 units.
            EXPECT_NEAR(glm::length(reading(with.look(eye, target)) - reading(without.look(eye, target))), 0,
                        2 * hit_roundings);
        }
    }
}

TEST(NormalIncidence, passes_straight_on_whatever_the_index) {
    for (const double ior : {1.33, 2.4}) {
        Probe slab(slab_above_ruler(0.5, -2, ior));
        EXPECT_EQ(slab.look({4.25, 3, 1}, {4.25, 0, 1}).x, 4.25 / 16);  // theta = 0: not a bit of the way changes
        SceneBuilder b;
        b.add_sphere({0, 0, 0}, 1, b.add_material(clear(ior)));
        add_ruler(b, {-2, -2, 2}, {0, 4, 0}, {4, 0, 0});
        Probe ball(b.scene);
        const dvec3 eye(0.5, -0.25, -3);  // through the centre, to the ruler at z = 2
        const dvec2 seen = reading(ball.look(eye, {0, 0, 0}));
        EXPECT_NEAR(seen.x, (0.25 * 2 / 3 + 2) / 4, 3 * hit_roundings);
        EXPECT_NEAR(seen.y, (-0.5 * 2 / 3 + 2) / 4, 3 * hit_roundings);
    }
}

}  // namespace
}  // namespace raymill::truths
