// What the benchmark's scenes are made of: tessellated patches, boxes, cylinders and spheres, appended to a scene.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>

#include "scene/scene.hpp"

namespace raymill::bench {

/// Random numbers that are the same on every machine.
class Random {
  public:
    explicit Random(std::uint32_t seed) : seed_(seed) {}
    /// In [0, 1).
    float uniform();
    float uniform(float from, float to) { return from + (to - from) * uniform(); }
    glm::vec3 in_box(const glm::vec3& lower, const glm::vec3& upper);
    /// Unit, evenly distributed.
    glm::vec3 direction();

  private:
    std::uint32_t seed_;
    std::uint32_t count_ = 0;
};

/// A point of a surface for (u, v) in the unit square.
using Surface = std::function<glm::vec3(float u, float v)>;

/// 2 * columns * rows triangles.
void add_grid(Scene& scene, int columns, int rows, const Surface& surface);

/// About `triangles` of them, on the parallelogram from `corner`.
void add_patch(Scene& scene, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, double triangles);

/// Six patches. triangles: about, in all; at least 12.
void add_box(Scene& scene, const glm::vec3& lower, const glm::vec3& upper, double triangles);

/// An upright cylinder with caps, `profile(h)` times as wide at height h in [0, 1].
void add_cylinder(Scene& scene, const glm::vec3& base, float height, float radius,
                  const std::function<float(float)>& profile, double triangles);

/// Twelve times a square number of triangles: the faces of a cube, on the sphere, at `radius(direction)` from `center`.
void add_globe(Scene& scene, const glm::vec3& center, const std::function<float(const glm::vec3&)>& radius,
               double triangles);

void add_triangle(Scene& scene, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

/// Smooth noise in [-1, 1], and its sum over octaves that halve in size and height.
float noise(const glm::vec3& p);
float fractal_noise(glm::vec3 p, int octaves);

}  // namespace raymill::bench
