// Whole images, pixel by pixel, beside those of the scalar double-precision tracer: each feature in a scene of its own.
#include "reference/reference.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "lib/random.h"
#include "rendering.hpp"

namespace raymill {
namespace {

using glm::dvec3;
using glm::dvec4;

// A pixel is the outcome of a few hundred float operations, each within 2^-24 = 6e-8: some 2e-5 of the light that
// passes through it, for which the brighter of the pixel and a grey of 0.1 stands. Highlights (their exponent is 50 at
// most, on a part of the light) and rays bent by curved surfaces magnify single errors, not all of them: twice that is
// allowed.
constexpr double relative_bound = 4e-5;
constexpr double darkest = 0.1;

// Where a ray that is turned by this much sees something else, the pixel lies on an edge: single precision places hit
// points within 1e-6 of the size of these scenes, and one or two reflections on curved surfaces magnify it tenfold.
constexpr double nudge = 1e-5;

double bound_at(const dvec4& value) {
    return relative_bound * std::max({darkest, value.x, value.y, value.z});
}

double distance(const dvec4& a, const dvec4& b) {
    double largest = 0;
    for (int i = 0; i < 4; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

/// The reference's pixel, every camera ray of it turned and moved sideways by at most `nudge` times `shift`.
dvec4 nudged_pixel(const reference::Tracer& tracer, const RenderSettings& settings, int x, int y, const dvec3& shift) {
    const uint path = path_camera(settings.seed, static_cast<uint>(y * settings.width + x));
    dvec4 sum(0);
    for (uint sample = 0; sample < static_cast<uint>(settings.spp); ++sample) {
        reference::Ray ray = tracer.camera_ray(x, y, sample);
        ray.direction = glm::normalize(ray.direction + nudge * shift);
        ray.origin += nudge * shift;
        const double hit = tracer.intersect(ray).primitive == NO_INDEX ? 0 : 1;
        sum += dvec4(tracer.radiance(ray, 0, sample, path), hit);
    }
    return sum / static_cast<double>(settings.spp);
}

/// Whether the reference itself changes by more than the bound near the pixel's rays.
bool is_on_an_edge(const reference::Tracer& tracer, const RenderSettings& settings, int x, int y, const dvec4& value) {
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 shift(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        if (distance(nudged_pixel(tracer, settings, x, y, shift), value) > bound_at(value)) return true;
    }
    return false;
}

struct Feature {
    const char* name;
    std::string toml;
};

std::ostream& operator<<(std::ostream& out, const Feature& feature) {
    return out << feature.name;
}

/// Floor, sphere and box in front of the camera; the parts that features change come after.
std::string still_life(const std::string& render_keys = "", const std::string& camera_keys = "fov = 40") {
    return fmt::format(R"(
[render]
size = [32, 24]
background = [0.2, 0.3, 0.5]
{}
[camera]
eye = [0.3, 1.7, 5]
look_at = [0, 0.7, 0]
{}
[[object]]
shape = "plane"
material = "floor"
point = [0, 0, 0]
normal = [0.05, 1, 0.02]
[[object]]
shape = "sphere"
material = "ball"
center = [-0.9, 0.9, 0.2]
radius = 0.8
[[object]]
shape = "box"
material = "box"
min = [0.3, 0.1, -0.6]
max = [1.5, 1.2, 0.5]
rotate = [0, 20, 0]
)",
                       render_keys, camera_keys);
}

std::string material(const std::string& name, const std::string& keys) {
    return fmt::format("[[material]]\nname = \"{}\"\n{}\n", name, keys);
}

std::string plain_materials() {
    return material("floor", "diffuse = [0.7, 0.6, 0.5]") + material("ball", "diffuse = [0.2, 0.5, 0.8]") +
           material("box", "diffuse = [0.8, 0.3, 0.2]");
}

std::string light(const std::string& type, const std::string& keys) {
    return fmt::format("[[light]]\ntype = \"{}\"\n{}\n", type, keys);
}

std::string sun() {
    return light("directional", "direction = [-1, -2.1, -1.3]\nintensity = 0.8");
}

/// Near enough that every point has a brightness of its own, so that a ray that goes astray shows.
std::string lamp() {
    return light("point", "position = [1.5, 3, 2.5]\nintensity = 6\nattenuation = [0.5, 0.25, 0.25]");
}

std::vector<Feature> light_features() {
    const std::string base = still_life() + plain_materials();
    const std::string sampled = still_life("spp = 2") + plain_materials();
    return {
        {"ambient_and_directional",
         still_life() + material("floor", "ambient = [0.5, 0.2, 0.1]") + material("ball", "ambient = 0.3") +
             material("box", "emission = [0.1, 0.2, 0.3]") + light("ambient", "color = [0.5, 1.0, 0.8]") + sun()},
        {"point_attenuated",
         base + light("point", "position = [2, 4, 3]\nintensity = 9\nattenuation = [0.5, 0.25, 0.125]")},
        {"point_soft", sampled + light("point", "position = [2, 4, 3]\nradius = 0.6\nsamples = 3")},
        {"spot", base + light("spot",
                              "position = [1, 5, 3]\ndirection = [-0.3, -1, -0.7]\nintensity = 1.5\n"
                              "inner_angle = 12\nouter_angle = 25")},
        {"rectangle", sampled + light("rectangle",
                                      "center = [0, 3.1, 0.4]\nedge_u = [1, 0, 0]\nedge_v = [0, 0, 1.2]\n"
                                      "radiance = 3\nsamples = 2")},
        {"disk", sampled + light("disk", "center = [1, 3, 2]\nnormal = [-0.3, -1, -0.6]\nradius = 0.7\nradiance = 4")},
        {"sphere",
         sampled + light("sphere", "center = [1.2, 3, 1.5]\nradius = 0.4\nradiance = [5, 4, 3]\nsamples = 2")},
        {"environment", base + light("environment", "map = \"checker.exr\"\nradiance = 0.7") + sun()},
    };
}

std::vector<Feature> surface_features() {
    const std::string shiny = "specular = 0.6\nshininess = 50\n";
    const auto shaded = [&](const std::string& shading) {
        return still_life() + material("floor", "diffuse = 0.5") +
               material("ball", "diffuse = [0.2, 0.5, 0.8]\n" + shiny + "highlight = \"blinn\"") +
               material("box", "diffuse = [0.8, 0.3, 0.2]\n" + shiny + "shading = \"" + shading + "\"") +
               "[[object]]\nmaterial = \"box\"\n" + sphere_mesh_keys(0.2, 0.6, 1.4, 0.6, 6) + sun() +
               light("point", "position = [2, 4, 3]\nintensity = 0.4");
    };
    return {
        {"shading_flat", shaded("flat")},
        {"shading_gouraud", shaded("gouraud")},
        {"shading_phong", shaded("phong")},
        {"checker_and_texture",
         still_life() + material("floor", "diffuse_checker = { a = 0.9, b = [0.1, 0.2, 0.1], scale = 0.45 }") +
             material("ball", "diffuse_checker = { a = [0.9, 0.1, 0.1], b = 0.8, scale = 0.31 }") +
             material("box", "diffuse = 0.5") + material("picture", "diffuse_map = \"checker.exr\"") +
             "[[object]]\nshape = \"triangle\"\nmaterial = \"picture\"\nvertices = [[-2, 0.4, -1], [2, 0.5, -1.2], "
             "[0, 2.6, -1.1]]\nuvs = [[-0.3, 0.1], [1.4, 0], [0.5, 1.7]]\n" +
             sun()},
    };
}

std::vector<Feature> ray_features() {
    const std::string glass = "diffuse = 0.1\nreflection = 0.15\ntransmission = 0.8\nbase_color = [0.9, 1, 0.8]\n";
    const auto clear = [&](const std::string& keys) {
        return plain_materials().substr(0, plain_materials().find("[[material]]\nname = \"ball\"")) +
               material("ball", glass + keys) + material("box", glass + keys) + lamp();
    };
    const auto mirror = material("floor", "diffuse = 0.5\nreflection = 0.3") +
                        material("ball", "diffuse = 0.1\nreflection = 0.8\nbase_color = [1, 0.9, 0.6]") +
                        material("box", "diffuse = [0.8, 0.3, 0.2]\nreflection = 0.2") + lamp();
    // Seen from inside a dense medium: most rays meet the plane beyond the critical angle.
    const std::string under_water = R"(
[render]
size = [32, 24]
depth = 3
background = [0.9, 0.8, 0.7]
[camera]
eye = [0, -1, 0]
look_at = [0, 0, 1]
fov = 100
[[material]]
name = "water"
transmission = 1
ior = 1.33
[[material]]
name = "bed"
diffuse_checker = { a = 0.8, b = 0.2, scale = 1.3 }
emission = [0.1, 0.05, 0]
[[object]]
shape = "plane"
material = "water"
point = [0, 0, 0]
normal = [0, 1, 0]
[[object]]
shape = "plane"
material = "bed"
point = [0, -3.1, 0]
normal = [0, 1, 0]
)" + lamp();
    return {
        {"mirrors", still_life("depth = 4") + mirror},
        {"refraction", still_life("depth = 4") + clear("ior = 1.3")},
        {"fresnel_and_absorption",
         still_life("depth = 4") + clear("ior = 1.5\nfresnel = true\nabsorption = [0.9, 0.2, 0.4]")},
        {"denser_outside", still_life("depth = 3") + clear("ior = 1.0\nexterior_ior = 1.4")},
        {"total_internal_reflection", under_water},
        {"shadows_filtered", still_life("depth = 0") + clear("")},
        {"shadows_opaque", still_life("depth = 0\nshadows = \"opaque\"") + clear("")},
        {"shadows_none", still_life("depth = 0\nshadows = \"none\"") + clear("")},
        {"lens", still_life("spp = 4", "fov = 40\naperture = 0.3\nfocus = 4.4") + plain_materials() + lamp()},
        {"orthographic", still_life("", "projection = \"orthographic\"\nheight = 3.1") + plain_materials() + lamp()},
    };
}

std::vector<Feature> all_features() {
    std::vector<Feature> features = light_features();
    for (const auto& more : {surface_features(), ray_features()})
        features.insert(features.end(), more.begin(), more.end());
    return features;
}

class WholeImage : public testing::TestWithParam<Feature> {};

TEST_P(WholeImage, is_that_of_the_reference) {
    const Scene scene = scene_of(GetParam().toml);
    const RenderSettings& settings = scene.settings;
    const reference::Tracer tracer(scene);
    const Frame frame = render(scene);
    int on_edges = 0;
    double darkest_pixel = INFINITY, brightest_pixel = 0;
    for (int y = 0; y < settings.height; ++y)
        for (int x = 0; x < settings.width; ++x) {
            const float* rgba = frame.rgba.data() + static_cast<std::size_t>(y * settings.width + x) * FILM_CHANNELS;
            const dvec4 rendered(rgba[0], rgba[1], rgba[2], rgba[3]);
            const dvec4 expected = tracer.pixel(x, y);
            darkest_pixel = std::min(darkest_pixel, expected.x);
            brightest_pixel = std::max(brightest_pixel, expected.x);
            if (distance(rendered, expected) <= bound_at(expected)) continue;
            const bool excused = is_on_an_edge(tracer, settings, x, y, expected);
            on_edges += excused;
            EXPECT_TRUE(excused) << fmt::format("pixel {}, {}: {} {} {} {} instead of {} {} {} {}", x, y, rendered.x,
                                                rendered.y, rendered.z, rendered.w, expected.x, expected.y, expected.z,
                                                expected.w);
        }
    EXPECT_LE(on_edges, settings.width * settings.height / 100);
    EXPECT_GT(brightest_pixel, darkest_pixel + 0.1);  // a picture of something
}

INSTANTIATE_TEST_SUITE_P(of, WholeImage, testing::ValuesIn(all_features()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace raymill
