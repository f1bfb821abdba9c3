// Flat, Gouraud and Phong shading, interpolation in perspective, checkers and textures.
#include <array>
#include <cmath>

#include "probe.hpp"

namespace raymill::truths {
namespace {

const std::array<glm::vec3, 3> corners = {glm::vec3(0, 0, 0), glm::vec3(3, 0, 0), glm::vec3(0, 3, 0)};
const dvec3 barycentre(1, 1, 0);
const dvec3 eye(1.5, 0.75, 4);
const dvec3 to_light = glm::normalize(dvec3(0.5, -0.25, 1));

std::array<glm::vec3, 3> corner_normals() {
    return {glm::vec3(glm::normalize(dvec3(-1, -1, 2))), glm::vec3(glm::normalize(dvec3(1, 0, 1))),
            glm::vec3(glm::normalize(dvec3(0, 1, 1)))};
}

/// The triangle above, its diffuse light in the first channel and its highlight (alpha = 8) in the second.
Scene shaded_triangle(Shading shading) {
    SceneMaterial material = black();
    material.diffuse = {1, 0, 0};
    material.specular = {0, 1, 0};
    material.shininess = 8;
    material.shading = shading;
    SceneBuilder b;
    b.add_triangle(corners, b.add_material(material), corner_normals());
    b.add_light(directional_light(-to_light));
    return b.scene;
}

/// Phong's formula with the normal as it is given, of unit length or not.
dvec3 phong(const dvec3& n, const dvec3& at) {
    const dvec3 v = glm::normalize(eye - at), r = 2 * glm::dot(n, to_light) * n - to_light;
    return {std::max(glm::dot(n, to_light), 0.0), std::pow(std::max(glm::dot(v, r), 0.0), 8), 0};
}

/// A power of 8 magnifies the relative error of its base eightfold; values are at most 1.
constexpr double bound = 9 * hit_roundings;

TEST(FlatShading, uses_the_normal_of_the_face) {
    Probe probe(shaded_triangle(Shading::flat));
    expect_seen(probe, eye, barycentre, phong({0, 0, 1}, barycentre), bound);
}

TEST(GouraudShading, interpolates_the_colours_of_the_vertices) {
    Probe probe(shaded_triangle(Shading::gouraud));
    dvec3 mean(0);  // at the barycentre each vertex weighs a third; Gouraud 1971
    for (std::size_t i = 0; i < 3; ++i) mean += phong(dvec3(corner_normals()[i]), dvec3(corners[i])) / 3.0;
    expect_seen(probe, eye, barycentre, mean, bound);
}

TEST(PhongShading, interpolates_the_normals_and_renormalises) {
    dvec3 mean(0);
    for (const glm::vec3& normal : corner_normals()) mean += dvec3(normal) / 3.0;
    const dvec3 expected = phong(glm::normalize(mean), barycentre);
    const dvec3 not_renormalised = phong(mean, barycentre);  // the bug that must not appear: |mean| = 0.79
    Probe probe(shaded_triangle(Shading::phong));
    expect_seen(probe, eye, barycentre, expected, bound);
    EXPECT_GT(glm::length(not_renormalised - expected), 0.1);
}

TEST(Interpolation, of_texture_coordinates_is_that_of_space_and_not_of_the_screen) {
    SceneBuilder b;
    // A floor that runs away from the eye: from z = 1 to z = -7.
    add_ruler(b, {-2, 0, 1}, {4, 0, 0}, {0, 0, -8});
    b.scene.settings.width = 1;
    b.scene.settings.height = 16;
    b.scene.camera.eye = {0, 1, 2};
    b.scene.camera.look_at = {0, 0, -0.5};
    b.scene.camera.fov = 20;
    Probe probe(b.scene);
    const Frame frame = probe.frame();
    const reference::Tracer tracer(b.scene);
    double largest_gap = 0;
    const auto read = [&](std::size_t y) { return frame.rgba[4 * y + 1] / frame.rgba[4 * y + 2]; };
    for (std::size_t y = 0; y < 16; ++y) {
        // The ray meets the floor at eye - d eye.y / d.y; the ruler reads that distance over its 8 units.
        const dvec3 d = tracer.camera_ray(0, static_cast<int>(y), 0).direction;
        const double expected = (1 - (2 - d.z / d.y)) / 8;
        EXPECT_NEAR(read(y), expected, hit_roundings * 4) << y;  // four units from the eye, and slanted
        const double on_screen = read(15) + (read(0) - read(15)) * static_cast<double>(15 - y) / 15;
        largest_gap = std::max(largest_gap, std::abs(on_screen - expected));
    }
    EXPECT_GT(largest_gap, 0.02);  // linear on the screen would be seen
}

TEST(Checker, shows_its_colours_by_the_parity_of_the_cell) {
    SceneMaterial material;
    material.diffuse_checker = Checker{{0.25f, 0.5f, 1}, {0.75f, 0.125f, 0}, 0.5f};
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    b.add_light(directional_light({0, -1, 0}));
    Probe probe(b.scene);
    for (const double x : {-1.25, -0.75, -0.25, 0.25, 0.75, 1.25})
        for (const double z : {-0.6, 0.1, 0.4, 0.7}) {
            SCOPED_TRACE(testing::Message() << x << ' ' << z);
            // odd(floor(x / s) + floor(z / s)) chooses; the light is 1 and falls straight.
            const bool odd = static_cast<int>(std::floor(x / 0.5) + std::floor(z / 0.5)) % 2 != 0;
            const dvec3 expected = odd ? dvec3(0.75, 0.125, 0) : dvec3(0.25, 0.5, 1);
            expect_seen(probe, {x, 3, z}, {x, 0, z}, expected, 0);
        }
}

TEST(Checker, changes_colour_at_the_border_of_its_cells) {
    SceneMaterial material;
    material.diffuse_checker = Checker{glm::vec3(1), glm::vec3(0), 0.5f};
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    b.add_light(directional_light({0, -1, 0}));
    Probe probe(b.scene);
    const double edge = find_edge(0.25, 0.75, [&](double x) { return probe.look({x, 3, 0.2}, {x, 0, 0.2}).x > 0.5; });
    // Cells are moved by 1/4096 of their size, and floats at 0.5 are half a rounding apart.
    EXPECT_NEAR(edge, 0.5 - 0.5 / 4096, hit_roundings);
}

/// A square of side 4 at z = 0 with uv from (-1, -1) to (1, 1), in a texture of 2 x 2 primary colours and white.
Scene textured_square() {
    SceneBuilder b;
    TextureImage image;
    image.width = image.height = 2;
    image.texels = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};  // the top row first
    b.scene.images.push_back(image);
    SceneMaterial material;
    material.diffuse = {0.5f, 1, 0.25f};
    material.diffuse_map = 0;
    const std::uint32_t id = b.add_material(material);
    const glm::vec2 low(-1), high(1);
    b.add_triangle({glm::vec3(-2, -2, 0), glm::vec3(2, -2, 0), glm::vec3(2, 2, 0)}, id, {}, {low, {1, -1}, high});
    b.add_triangle({glm::vec3(-2, -2, 0), glm::vec3(2, 2, 0), glm::vec3(-2, 2, 0)}, id, {}, {low, high, {-1, 1}});
    b.add_light(directional_light({0, 0, -1}));
    return b.scene;
}

/// k_d times the texture's colour at (u, v).
void expect_texture(double u, double v, const dvec3& color) {
    SCOPED_TRACE(testing::Message() << "uv " << u << ' ' << v);
    // Two texels a unit of uv: a texture coordinate's error changes the colour twice as much.
    Probe probe(textured_square());
    expect_seen(probe, {2 * u, 2 * v, 3}, {2 * u, 2 * v, 0}, dvec3(0.5, 1, 0.25) * color, 2 * hit_roundings);
}

TEST(Texture, shows_a_texel_at_its_centre_with_v_upwards_and_multiplies_the_diffuse_colour) {
    expect_texture(0.25, 0.75, {1, 0, 0});
    expect_texture(0.75, 0.75, {0, 1, 0});
    expect_texture(0.25, 0.25, {0, 0, 1});
    expect_texture(0.75, 0.25, {1, 1, 1});
}

TEST(Texture, is_bilinear_between_the_centres) {
    expect_texture(0.5, 0.75, {0.5, 0.5, 0});
    expect_texture(0.25, 0.375, {0.25, 0, 0.75});
    // Weights 3/8, 5/8 across and 3/4, 1/4 down: all four texels.
    expect_texture(0.5625, 0.625, {0.28125 + 0.15625, 0.46875 + 0.15625, 0.09375 + 0.15625});
}

TEST(Texture, repeats) {
    expect_texture(-0.75, 0.75, {1, 0, 0});
    expect_texture(-0.25, -0.75, {1, 1, 1});
    expect_texture(0, 0.75, {0.5, 0.5, 0});  // between the last column and the first
}

}  // namespace
}  // namespace raymill::truths
