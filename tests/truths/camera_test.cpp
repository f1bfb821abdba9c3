// What the camera makes of the world: silhouettes and the blur of its lens.
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

constexpr double pi = glm::pi<double>();

TEST(Silhouette, of_a_sphere_has_the_angular_radius_asin_r_over_d) {
    for (const double radius : {0.1, 0.5, 1.9}) {
        SCOPED_TRACE(radius);
        SceneBuilder b;
        b.add_sphere({0, 0, 0}, static_cast<float>(radius), b.add_material(emitter(glm::vec3(1))));
        Probe probe(b.scene);
        const dvec3 eye(0, 0, 2);
        const double edge = find_edge(0, degrees(85), [&](double angle) {
            return probe.look(eye, eye + dvec3(std::sin(angle), 0, -std::cos(angle))).x > 0;
        });
        const double expected = std::asin(static_cast<double>(static_cast<float>(radius)) / 2);
        // The perpendicular's square is off by 8 roundings of d^2 and the direction by 5: d / 2r of the first as an
        // angle, steeper by 1 / cos where the sphere fills the view.
        EXPECT_NEAR(edge, expected, rounding * (5 + 8 * 2 / (2 * radius)) / std::cos(expected));
    }
}

/// Counts pixels of one row that see something.
int lit_pixels(const Frame& frame) {
    int count = 0;
    for (std::size_t i = 0; i < frame.rgba.size(); i += 4) count += frame.rgba[i] > 0;
    return count;
}

/// A row of 511 pixels across a sphere of radius 1 at the origin, seen from z = 4.
Scene row_across_a_sphere(Projection projection) {
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, b.add_material(emitter(glm::vec3(1))));
    b.scene.settings.width = 511;
    b.scene.camera.projection = projection;
    b.scene.camera.eye = {0, 0, 4};
    b.scene.camera.look_at = {0, 0, 0};
    b.scene.camera.fov = 2 * glm::degrees(std::atan(0.5 / 511));  // the row is one unit wide at unit distance
    b.scene.camera.height = 3.0 / 511;
    return b.scene;
}

TEST(Silhouette, covers_the_pixels_that_projection_gives_it) {
    // Perspective: tan(asin(1 / 4)) to each side of a film one unit wide; odd counts, since the middle is a centre.
    const double half = 511 * std::tan(std::asin(0.25));
    EXPECT_EQ(lit_pixels(Probe(row_across_a_sphere(Projection::perspective)).frame()), 2 * std::floor(half) + 1);
    // Orthographic: one of 1.5 units to each side.
    const double straight = 511.0 / 3;
    EXPECT_EQ(lit_pixels(Probe(row_across_a_sphere(Projection::orthographic)).frame()), 2 * std::floor(straight) + 1);
}

/// A lens of diameter 0.5 focused at 2, before the edge of a bright half-plane x < 0 at this distance.
Probe& lens_before_an_edge(double distance) {
    static std::unique_ptr<Probe> probe;
    SceneBuilder b;
    const float z = static_cast<float>(-distance);
    b.add_quad({-99, -99, z}, {0, -99, z}, {0, 99, z}, {-99, 99, z}, b.add_material(emitter(glm::vec3(1))));
    b.scene.settings.spp = 256;
    b.scene.camera.fov = 1e-4;  // a pixel far smaller than the blur
    b.scene.camera.aperture = 0.5;
    b.scene.camera.focus = 2;
    probe = std::make_unique<Probe>(b.scene);
    return *probe;
}

TEST(Lens, blurs_a_point_out_of_focus_to_a_uniform_circle_of_the_thin_lens_size) {
    for (const double distance : {1.0, 3.0, 5.0}) {
        Probe& probe = lens_before_an_edge(distance);
        // Similar triangles about the point in focus: at this distance the lens's cone has radius (A / 2) |z - f| / f.
        const double radius = 0.25 * std::abs(distance - 2) / 2;
        for (const double share : {-1.01, -0.7, 0.0, 0.4, 1.01}) {
            SCOPED_TRACE(testing::Message() << distance << ' ' << share);
            const double x = share * radius;
            const Estimate e = estimate(probe, {x, 0, 0}, {x, 0, -1}, 24);
            // The share of a disk to the left of a line at -s of its radius: 1/2 - (asin(s) + s sqrt(1 - s^2)) / pi.
            const double s = std::clamp(share, -1.0, 1.0);
            const double expected = 0.5 - (std::asin(s) + s * std::sqrt(1 - s * s)) / pi;
            if (std::abs(share) > 1)
                EXPECT_EQ(e.mean.x, share < 0 ? 1 : 0);
            else
                expect_estimate(e, expected);
        }
    }
}

TEST(Lens, leaves_what_is_in_focus_sharp) {
    Probe& probe = lens_before_an_edge(2);
    // 1e-5 is twice the pixel and above the roundings of points on a lens of 0.25 that meet 2 units away.
    EXPECT_EQ(probe.look({-1e-5, 0, 0}, {-1e-5, 0, -1}).x, 1);
    EXPECT_EQ(probe.look({1e-5, 0, 0}, {1e-5, 0, -1}).x, 0);
}

}  // namespace
}  // namespace raymill::truths
