// Ambient, Lambert, Phong, Blinn, emission, and that light adds up: the lecture's local illumination.
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

const dvec3 origin(0);

dvec3 in_plane(double angle_from_y) {
    return {std::sin(angle_from_y), std::cos(angle_from_y), 0};
}

/// A floor y = 0 of this material.
SceneBuilder floor_of(const SceneMaterial& material) {
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    return b;
}

TEST(Ambient, is_k_a_times_the_sum_of_the_ambient_lights_even_where_no_other_light_comes) {
    SceneMaterial material = black();
    material.ambient = {0.5f, 1, 0.25f};
    SceneBuilder b = floor_of(material);
    b.add_plane({0, 3, 0}, {0, -1, 0});  // a lid: k_a I_a is never shadowed
    b.add_light(AmbientLight{{0.25f, 0.5f, 1}});
    b.add_light(AmbientLight{{0.5f, 0.25f, 0}});
    Probe probe(b.scene);
    // I = k_a (I_1 + I_2): sums and products of short binary fractions are exact.
    expect_seen(probe, {1, 2, 0}, origin, {0.375, 0.75, 0.25}, 0);
}

TEST(Lambert, is_the_cosine_at_every_angle_from_0_to_91_degrees) {
    SceneBuilder b;
    SceneMaterial material = black();
    material.diffuse = glm::vec3(0.5f);
    b.add_sphere({0, 0, 0}, 1, b.add_material(material));
    b.add_light(directional_light({0, -1, 0}));
    Probe probe(b.scene);
    for (int angle = 0; angle <= 91; ++angle) {
        SCOPED_TRACE(angle);
        // I = k_d max(cos(theta), 0) I_in, Lambert 1760. The normal under the eye is the unit vector to it.
        const double expected = 0.5 * std::max(std::cos(degrees(angle)), 0.0);
        expect_seen(probe, 3.0 * in_plane(degrees(angle)), origin, dvec3(expected), 0.5 * hit_roundings);
    }
}

/// How far base^exponent may be off: its base by 18 roundings (two unit vectors, a mirror direction, a dot product),
/// the power itself by what lib/math.h states and the film's unit.
double power_bound(double base, double exponent) {
    const double high = std::pow(std::min(base + 18 * rounding, 1.0), exponent);
    const double low = std::pow(std::max(base - 18 * rounding, 0.0), exponent);
    const double steps = base > 0 ? 4 + 4 * exponent * std::abs(std::log2(base)) : 0;
    return high - low + rounding * steps * std::pow(base, exponent) + std::ldexp(1, -32);
}

class HighlightShape : public testing::TestWithParam<float> {};

/// Looks at the origin of a shiny floor lit from 30 degrees to the left, from many angles.
void expect_highlight(Highlight highlight, float shininess, double (*cosine)(double view_angle)) {
    SceneMaterial material = black();
    material.specular = glm::vec3(1);
    material.shininess = shininess;
    material.highlight = highlight;
    SceneBuilder b = floor_of(material);
    b.add_light(directional_light(in_plane(degrees(-30)) * -1.0));
    Probe probe(b.scene);
    for (const double view : {-85.0, -75.0, -60.5, -30.0, 0.0, 20.0, 29.0, 30.0, 31.0, 45.0, 60.0, 85.0}) {
        SCOPED_TRACE(view);
        const double c = std::max(cosine(degrees(view)), 0.0);
        const double expected = shininess == 0 ? 1 : std::pow(c, shininess);
        expect_seen(probe, 3.0 * in_plane(degrees(view)), origin, dvec3(expected), power_bound(c, shininess));
    }
}

TEST_P(HighlightShape, of_phong_is_the_power_of_the_angle_to_the_mirror_direction) {
    // I = k_s max(v.r, 0)^alpha I_in, Phong 1975: r lies 30 degrees to the right, so v.r = cos(view - 30).
    expect_highlight(Highlight::phong, GetParam(), [](double view) { return std::cos(view - degrees(30)); });
}

TEST_P(HighlightShape, of_blinn_is_the_power_of_the_angle_to_the_half_vector) {
    // I = k_s max(n.h, 0)^alpha I_in, Blinn 1977: h is halfway between -30 degrees and the view.
    expect_highlight(Highlight::blinn, GetParam(), [](double view) { return std::cos(0.5 * (view - degrees(30))); });
}

INSTANTIATE_TEST_SUITE_P(Shininess, HighlightShape, testing::Values(0.0f, 1.0f, 10.0f, 100.0f, 1000.0f));

/// A triangle of z = 0 around the origin, whose shading normal is tilted by this angle about y.
SceneBuilder tilted_triangle(double tilt, const dvec3& light_direction) {
    SceneBuilder b;
    SceneMaterial material = white();
    material.specular = glm::vec3(1);
    material.shininess = 0;
    const glm::vec3 n(dvec3(std::sin(tilt), 0, std::cos(tilt)));
    b.add_triangle({glm::vec3(-1, -1, 0), glm::vec3(2, -1, 0), glm::vec3(-1, 2, 0)}, b.add_material(material),
                   {n, n, n});
    b.add_light(directional_light(light_direction));
    return b;
}

TEST(Guard, a_light_below_the_shading_normals_horizon_gives_neither_diffuse_nor_highlight) {
    const auto seen = [](double light_angle) {
        const dvec3 to_light(std::sin(light_angle), 0, std::cos(light_angle));
        return look(tilted_triangle(degrees(-40), -to_light).scene, {0, 0, 2}, {0, 0, 0}).x;
    };
    // The horizon of a normal at -40 degrees is at 50. With alpha = 0 the highlight is 1 up to there: cos(theta) + 1.
    EXPECT_NEAR(seen(degrees(49.9)), std::cos(degrees(89.9)) + 1, hit_roundings);
    EXPECT_EQ(seen(degrees(50.1)), 0);
}

TEST(Guard, a_light_behind_a_smooth_triangle_is_in_its_shadow_even_if_the_shading_normal_sees_it) {
    const auto seen = [](double light_angle) {
        const dvec3 to_light(std::sin(light_angle), 0, std::cos(light_angle));
        return look(tilted_triangle(degrees(40), -to_light).scene, {0, 0, 2}, {0, 0, 0}).x;
    };
    EXPECT_NEAR(seen(degrees(89.9)), std::cos(degrees(49.9)) + 1, hit_roundings);
    // The shading normal sees it at 80 degrees. Shadow rays of smooth triangles start above them, here by 0.33, and
    // this one comes down on the triangle 0.84 from its middle, within its edge at 1.
    EXPECT_EQ(seen(degrees(120)), 0);
}

TEST(Guard, without_shadows_a_light_below_the_geometric_horizon_gives_nothing) {
    const auto seen = [](double light_angle) {
        const dvec3 to_light(std::sin(light_angle), 0, std::cos(light_angle));
        SceneBuilder b = tilted_triangle(degrees(40), -to_light);
        b.scene.settings.shadows = ShadowMode::none;
        return look(b.scene, {0, 0, 2}, {0, 0, 0}).x;
    };
    // The shading normal at 40 degrees sees both; the geometric one only the first. cos(theta) + 1, as above.
    EXPECT_NEAR(seen(degrees(89.9)), std::cos(degrees(49.9)) + 1, hit_roundings);
    EXPECT_EQ(seen(degrees(90.1)), 0);
}

TEST(Facing, both_sides_of_a_surface_are_lit_alike) {
    SceneBuilder b = floor_of(white());
    b.add_light(directional_light({0, 1, 0}, 0.75));  // from below
    Probe probe(b.scene);
    expect_seen(probe, {0, -2, 0}, origin, dvec3(0.75), 0);
    expect_seen(probe, {0, 2, 0}, origin, dvec3(0), 0);
}

/// Every colour of the lecture's formula, with one channel changed.
dvec3 seen_with_channel(int channel, float factor) {
    SceneMaterial material;
    material.ambient = {0.3f, 0.4f, 0.5f};
    material.diffuse = {0.6f, 0.5f, 0.7f};
    material.specular = {0.2f, 0.9f, 0.4f};
    material.emission = {0.1f, 0.2f, 0.3f};
    PointLight light = point_light({1, 2, 0});
    light.intensity = {1.5f, 0.7f, 1.1f};
    glm::vec3 ambient(0.3f);
    for (glm::vec3* color :
         {&material.ambient, &material.diffuse, &material.specular, &material.emission, &light.intensity, &ambient})
        (*color)[channel] *= factor;
    SceneBuilder b = floor_of(material);
    b.add_light(light);
    b.add_light(AmbientLight{ambient});
    return look(b.scene, {-1, 2, 0}, {0.1, 0, 0});
}

TEST(Channels, are_three_copies_of_the_formula_that_do_not_see_each_other) {
    const dvec3 before = seen_with_channel(0, 1);
    for (int changed = 0; changed < 3; ++changed) {
        const dvec3 after = seen_with_channel(changed, 1.7f);
        for (int channel = 0; channel < 3; ++channel) {
            if (channel == changed)
                EXPECT_GT(after[channel], 1.5 * before[channel]);
            else
                EXPECT_EQ(after[channel], before[channel]);
        }
    }
}

TEST(Emission, is_added_as_it_is_whatever_the_blend) {
    SceneMaterial material = emitter({0.25f, 0.5f, 4});
    material.reflection = 0.75f;
    SceneBuilder b = floor_of(material);
    Probe probe(b.scene);
    expect_seen(probe, {1, 2, 0}, origin, {0.25, 0.5, 4}, 0);  // L = L_e, in a dark room
}

/// An 8 by 8 picture of a floor and a sphere under those of two lights that are asked for.
std::vector<cl_long> picture_under(const std::vector<PointLight>& lights) {
    SceneMaterial material;
    material.diffuse = {0.5f, 0.7f, 0.9f};
    material.specular = glm::vec3(0.3f);
    material.shininess = 2;
    SceneBuilder b = floor_of(material);
    b.add_sphere({0.2f, 1, 0}, 1, 1);
    for (const PointLight& light : lights) b.add_light(light);
    b.scene.settings.width = b.scene.settings.height = 8;
    b.scene.camera.eye = {0, 3, 6};
    b.scene.camera.look_at = {0, 0.5, 0};
    return Probe(b.scene).frame().sums;
}

TEST(Superposition, the_film_under_two_lights_is_the_sum_of_the_films_under_each_to_the_last_unit) {
    const PointLight left = point_light({-3, 4, 2}, 1.3), right = point_light({4, 3, 1}, 0.6);
    const auto a = picture_under({left}), b = picture_under({right}), both = picture_under({left, right});
    std::size_t in_shadow_of_one = 0;
    for (std::size_t i = 0; i < both.size(); i += FILM_CHANNELS)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            EXPECT_EQ(both[i + channel], a[i + channel] + b[i + channel]);
            in_shadow_of_one += (a[i + channel] == 0) != (b[i + channel] == 0);
        }
    EXPECT_GT(in_shadow_of_one, 0u);
}

TEST(Superposition, twice_the_light_gives_exactly_twice_the_film) {
    const auto once = picture_under({point_light({-3, 4, 2}, 64)}),
               twice = picture_under({point_light({-3, 4, 2}, 128)});
    cl_long brightest = 0;
    for (std::size_t i = 0; i < once.size(); i += FILM_CHANNELS)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            // Doubling a float is exact. The film keeps all bits of what is above 2^-8; of the two terms of a hit, a
            // fainter highlight is rounded to one unit, which doubling can move by one.
            EXPECT_NEAR(static_cast<double>(twice[i + channel]), 2.0 * static_cast<double>(once[i + channel]), 1);
            brightest = std::max(brightest, once[i + channel]);
        }
    EXPECT_GT(brightest, cl_long{FILM_ONE});
}

}  // namespace
}  // namespace raymill::truths
