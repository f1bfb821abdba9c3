// How far the surface that a kernel finds at a hit may be from the reference's, for the same ray and the same hit.
#pragma once

#include "reference/reference.hpp"
#include "verify/bounded.hpp"

namespace raymill::verify {

struct SurfaceBounds {
    double position = 0;          // of each coordinate, scene units
    double offset = 0;            // a ray that leaves the surface starts at most this far from it
    double geometric_normal = 0;  // length of the error
    double shading_normal = 0;
    double uv = 0;      // of each coordinate
    double facing = 0;  // |cosine of the ray to the geometric normal| over its bound; below 1 the side is undecided
};

/// Counted in roundings over lib/surface.h; the first order alone, which is 2^-24 of the next.
SurfaceBounds surface_bounds(const Scene& scene, const reference::Ray& ray, const reference::Hit& hit,
                             const reference::Surface& surface);

}  // namespace raymill::verify
