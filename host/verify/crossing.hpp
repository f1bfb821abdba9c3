// Where a ray crosses one primitive in double precision, how clearly, and what single precision may make of it.
#pragma once

#include <vector>

#include "reference/reference.hpp"
#include "verify/bounded.hpp"

namespace raymill::verify {

/// One crossing of a ray's line with a primitive, or with the plane around a triangle.
/// margin is positive inside: the smallest barycentric weight of a triangle; 1 - (distance of the line to the centre /
/// radius)^2 of a sphere; |cosine| of a plane.
struct Crossing {
    double t = 0, u = 0, v = 0;
    double t_error = 0;       // bound on the kernel's error of t
    double left_out = 0;      // how near the origin the kernel may leave out what it has found
    double weight_error = 0;  // of u and v
    double margin = 0;
    double margin_error = 0;

    /// How clear it is that the ray does or does not meet the primitive in front of it: at least 1 is certain.
    double clarity() const;
    bool certain() const { return margin > margin_error && t > t_error + left_out; }
    bool possible() const { return margin >= -margin_error && t >= -t_error; }
};

/// Both ends of a chord, else one or none; sorted by t. Sources of the bounds: for triangles Pharr, Jakob, Humphreys,
/// PBR 4e, section 6.8.7; for spheres and planes, the roundings of lib/sphere.h and lib/traverse.h to first order.
std::vector<Crossing> crossings(const Scene& scene, const reference::Ray& ray, std::uint32_t primitive);

/// The one of them that is nearest to t; nullptr if there is none.
const Crossing* nearest(const std::vector<Crossing>& all, double t);

}  // namespace raymill::verify
