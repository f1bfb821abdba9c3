// Measuring a scene through the real renderer: one pixel in any direction, a ruler that says where a ray ends, means
// over independent seeds, and the edges of what is bright.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bvh/bvh.hpp"
#include "reference/scene_builder.hpp"
#include "wavefront/renderer.hpp"

namespace raymill::truths {

using glm::dvec2;
using glm::dvec3;
using reference::black;
using reference::emitter;
using reference::SceneBuilder;

/// Half a unit in the last place of 1: the relative error of one operation in single precision. Bounds count them.
inline constexpr double rounding = 5.9604644775390625e-8;
/// A camera ray's direction, the hit point and the normal there carry no more roundings than this together, relative to
/// the coordinates: unit vectors take 5 (dot product 2, root 1, reciprocal 1, product 1) and a hit 6 (edge functions,
/// weights, sums).
inline constexpr double hit_roundings = 16 * rounding;

inline double degrees(double angle) {
    return glm::radians(angle);
}

/// A scene on the device, looked at again and again: from elsewhere and with other seeds. Not to be moved.
class Probe {
  public:
    /// The scene's size, samples and depth stay; its camera is replaced by look(). Throws DeviceError.
    explicit Probe(Scene scene);
    Probe(const Probe&) = delete;
    Probe& operator=(const Probe&) = delete;

    /// Radiance of a single pixel whose centre looks from eye towards target, by the kernels.
    dvec3 look(const dvec3& eye, const dvec3& target);
    /// Same, by the scalar reference.
    dvec3 look_by_reference(const dvec3& eye, const dvec3& target);
    /// All pixels by the kernels, with the camera and the seed that scene() has now. Expects that every number was one.
    Frame frame();

    Scene& scene() { return scene_; }

  private:
    void aim(const dvec3& eye, const dvec3& target);

    Scene scene_;
    Bvh bvh_;
    Renderer renderer_;
};

/// Radiance seen from eye towards target, of a scene looked at only once.
dvec3 look(const Scene& scene, const dvec3& eye, const dvec3& target);

/// Expects the kernels and the reference to see this, each component within the bound.
void expect_seen(Probe& probe, const dvec3& eye, const dvec3& target, const dvec3& expected, double bound);

/// Mean and its standard error from independent frames.
struct Estimate {
    dvec3 mean{0};
    dvec3 error{0};
};
/// Looks once with each of `seeds` seeds.
Estimate estimate(Probe& probe, const dvec3& eye, const dvec3& target, int seeds = 48);
/// Expects the mean of the first channel within four standard errors (and hit_roundings), and the error below 2% of it,
/// so that the comparison means something.
void expect_estimate(const Estimate& estimate, double expected);

/// Where a predicate that is true at `inside` and false at `outside` changes, to the last step that doubles tell apart
/// in `steps` halvings.
double find_edge(double inside, double outside, const std::function<bool(double)>& is_inside, int steps = 26);

/// A textured rectangle that shows where it is hit: its colour is (x, y, 1) times what the path weighs, with x and y
/// running from 0 to 1 along its edges from `corner`. Adds the light that travels against edge_x cross edge_y; the
/// scene must have no shadows, which this sets.
void add_ruler(SceneBuilder& builder, const glm::vec3& corner, const glm::vec3& edge_x, const glm::vec3& edge_y);
/// A ruler's reading: what was seen over its third channel.
inline dvec2 reading(const dvec3& seen) {
    return {seen.x / seen.z, seen.y / seen.z};
}

/// The scene of this TOML text, by way of a temporary file.
Scene scene_of(const std::string& toml);

/// A black material that transmits everything.
inline SceneMaterial clear(double ior, double exterior_ior = 1) {
    SceneMaterial material = black();
    material.transmission = 1;
    material.ior = static_cast<float>(ior);
    material.exterior_ior = static_cast<float>(exterior_ior);
    return material;
}

inline SceneMaterial mirror(double reflection = 1) {
    SceneMaterial material = black();
    material.reflection = static_cast<float>(reflection);
    return material;
}

/// White Lambert.
inline SceneMaterial white() {
    SceneMaterial material;
    material.diffuse = glm::vec3(1);
    return material;
}

inline PointLight point_light(const dvec3& position, double intensity = 1) {
    PointLight light;
    light.position = position;
    light.intensity = glm::vec3(static_cast<float>(intensity));
    return light;
}

inline DirectionalLight directional_light(const dvec3& direction, double intensity = 1) {
    DirectionalLight light;
    light.direction = direction;
    light.intensity = glm::vec3(static_cast<float>(intensity));
    return light;
}

}  // namespace raymill::truths
