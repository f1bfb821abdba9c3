// No surface shadows itself: convex shapes in full light, at all scales and far from the origin.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ostream>

#include "reference/reference.hpp"
#include "rendering.hpp"

namespace raymill {
namespace {

using glm::dvec3;

/// Where the shape stands, and how large it is.
struct Place {
    const char* name;
    double scale;
    double offset;  // on each axis
};

constexpr Place places[] = {{"millimetres", 1e-3, 0},
                            {"metres", 1, 0},
                            {"kilometres", 1e3, 0},
                            {"megametres", 1e6, 0},
                            {"far_from_the_origin", 1, 1e4}};

std::string vector_at(const Place& place, const dvec3& p) {
    const dvec3 q = place.offset + place.scale * p;
    return fmt::format("[{}, {}, {}]", q.x, q.y, q.z);
}

std::string placed(const Place& place) {
    return fmt::format("scale = {}\nrotate = [11, 0, 7]\ntranslate = {}\n", place.scale, vector_at(place, dvec3(0)));
}

// Tilted, so that no coordinate of a surface is a number that floats hold exactly.
std::string plane(const Place& place) {
    return "shape = \"plane\"\nnormal = [0.12, 1, -0.19]\npoint = " + vector_at(place, dvec3(0));
}
std::string quad(const Place& place) {
    return "shape = \"rectangle\"\ncenter = [0, 0, 0]\nedge_u = [0, 0, 6]\nedge_v = [6, 0, 0]\n" + placed(place);
}
std::string grid(const Place& place) {
    return grid_mesh_keys(3, 12) + placed(place);
}
std::string ball(const Place& place) {
    return fmt::format("shape = \"sphere\"\ncenter = {}\nradius = {}", vector_at(place, dvec3(0)), place.scale);
}
std::string smooth_mesh(const Place& place) {
    return sphere_mesh_keys(0, 0, 0, 1, 12) + placed(place);
}

Scene lit_shape(const std::string& object, const Place& place, const std::string& light) {
    return scene_of(fmt::format("[render]\nsize = [64, 48]\n[camera]\neye = {}\nlook_at = {}\n{}\n[[object]]\n{}\n",
                                vector_at(place, {0.4, 3.1, 2.7}), vector_at(place, dvec3(0)), light, object));
}

std::string lamp(const Place& place) {
    return "[[light]]\ntype = \"point\"\nposition = " + vector_at(place, {3, 4, 1.3});
}
constexpr const char* sun = "[[light]]\ntype = \"directional\"\ndirection = [-1.7, -2.3, -0.9]";

Frame with(Scene scene, ShadowMode shadows, ShadowOffset offset) {
    scene.settings.shadows = shadows;
    scene.settings.shadow_offset = offset;
    return render(scene);
}

/// Whether the first light stands clearly above the geometric surface that the pixel sees. Below that, a flat facet of
/// a smooth mesh really does turn away from the light.
bool is_clearly_lit(const Scene& scene, const reference::Tracer& tracer, int x, int y) {
    constexpr double least_cosine = 0.05;
    const reference::Ray ray = tracer.camera_ray(x, y, 0);
    const reference::Hit hit = tracer.intersect(ray);
    if (hit.primitive == NO_INDEX) return false;
    const reference::Surface surface = tracer.surface(ray, hit);
    const uint path = 0;  // chooses among samples, of which these lights have one
    const reference::LightSample light = tracer.sample_light(0, 0, surface.position, 0, path);
    const double side = surface.inside ? -1 : 1;
    EXPECT_EQ(scene.lights.size(), 1u);
    return side * glm::dot(light.direction, surface.geometric_normal) > least_cosine;
}

struct Count {
    int lit = 0;
    int falsely_shadowed = 0;
};

/// Compares with the picture in which nothing is in shadow, where the light is clearly above the surface.
Count count_false_shadows(const Scene& scene, ShadowOffset offset) {
    const Frame truth = with(scene, ShadowMode::none, offset), frame = with(scene, ShadowMode::opaque, offset);
    const reference::Tracer tracer(scene);
    Count count;
    for (int y = 0; y < scene.settings.height; ++y)
        for (int x = 0; x < scene.settings.width; ++x) {
            const auto red = static_cast<std::size_t>(y * scene.settings.width + x) * FILM_CHANNELS;
            if (truth.sums[red] == 0 || !is_clearly_lit(scene, tracer, x, y)) continue;
            ++count.lit;
            count.falsely_shadowed += frame.sums[red] != truth.sums[red];
        }
    return count;
}

struct Shape {
    const char* name;
    std::string (*object)(const Place&);
};

std::ostream& operator<<(std::ostream& out, const Shape& shape) {
    return out << shape.name;
}

class Acne : public testing::TestWithParam<Shape> {};

TEST_P(Acne, is_nowhere) {
    for (const Place& place : places)
        for (const std::string& light : {lamp(place), std::string(sun)}) {
            SCOPED_TRACE(place.name);
            const Count count =
                count_false_shadows(lit_shape(GetParam().object(place), place, light), ShadowOffset::robust);
            EXPECT_GT(count.lit, 300);  // a tenth of the picture: there is something to see
            EXPECT_EQ(count.falsely_shadowed, 0) << "of " << count.lit << " lit pixels";
        }
}

TEST_P(Acne, shows_without_the_offset) {
    int falsely_shadowed = 0;
    for (const Place& place : places)
        falsely_shadowed +=
            count_false_shadows(lit_shape(GetParam().object(place), place, sun), ShadowOffset::none).falsely_shadowed;
    EXPECT_GT(falsely_shadowed, 0);
}

INSTANTIATE_TEST_SUITE_P(of, Acne,
                         testing::Values(Shape{"a_plane", plane}, Shape{"a_quad", quad}, Shape{"a_grid", grid},
                                         Shape{"a_sphere", ball}, Shape{"a_smooth_mesh", smooth_mesh}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace raymill
