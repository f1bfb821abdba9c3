// Hand-made hits on every kind of surface, and how far single precision may stray there: for tests of what follows a
// hit.
#pragma once

#include <vector>

#include "queues.hpp"
#include "random.hpp"

namespace raymill::test {

// Bounds of single precision on the surfaces below: fat triangles, spheres of radius 0.5 to 1.5 and planes, all
// coordinates of hits below 4. In units of ROUNDING, as lengths of vectors.
//   position: a triangle's has 4 roundings of 4 a coordinate (28); a sphere's the rounding of the hit point (7), its
//   normal
//     by the radius (12), the sum (7); a plane's the hit point, and 4 roundings of its projection (28).
//   normal: a triangle's edges and cross product have 5 roundings, times 4 for its shape, and 5 of normalisation; an
//     interpolated one 6 roundings, at most halved in length, and 5; a sphere's the hit point's 7, divided by the
//     radius, and 5.
inline constexpr double POSITION_ERROR = 32 * ROUNDING;
inline constexpr double NORMAL_ERROR = 32 * ROUNDING;

struct HitQueue {
    std::vector<Ray> rays;
    std::vector<Hit> hits;
};

/// Adds triangles (with and without normals), spheres and planes, each of them once for every material.
void add_surfaces(Scene& scene, std::uint32_t seed);

/// Rays at random points of random primitives, from both sides, a pixel each; weights, routes, samples and paths are
/// random. One in `miss_every` misses (0: none).
HitQueue random_hits(const Scene& scene, std::size_t count, std::uint32_t seed, uint miss_every = 0);

/// The height of a point over the surface of the hit primitive, positive outside, without rounding to speak of.
double height_over(const Scene& scene, uint primitive, const glm::dvec3& point);

}  // namespace raymill::test
