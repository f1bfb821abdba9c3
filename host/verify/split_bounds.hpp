// How far the weights and directions of secondary rays may be from the reference's, and how near the hit is to another
// split.
#pragma once

#include "reference/reference.hpp"
#include "verify/bounded.hpp"
#include "verify/surface_bounds.hpp"

namespace raymill::verify {

struct SplitBounds {
    double reflection = 0;  // of the shares
    double transmission = 0;
    double reflected = 0;  // of the directions, length of the error
    double refracted = 0;
    double margin =
        INFINITY;  // distance to the nearest branch over its bound: total reflection, a smooth normal's fallback
};

/// The index ratio n_transmitted / n_incident at a surface.
double index_ratio(const SceneMaterial& material, bool inside);

/// The first order counted over lib/material.h; where a root amplifies it, the reference's formulas at the ends of the
/// interval.
SplitBounds split_bounds(const Scene& scene, const reference::Ray& ray, const reference::Surface& surface,
                         const SurfaceBounds& bounds);

}  // namespace raymill::verify
