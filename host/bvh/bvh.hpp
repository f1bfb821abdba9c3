// The bounding volume hierarchy: eight children a node, leaves of eight triangles or spheres as structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "layout.h"

namespace raymill {

/// An axis-aligned box; empty while lower > upper.
struct Bounds {
    glm::vec3 lower{INFINITY};
    glm::vec3 upper{-INFINITY};
};

struct BvhStatistics {
    std::size_t dropped_not_finite = 0;  // triangles with a NaN or infinite vertex: left out
    std::size_t dropped_zero_area = 0;   // triangles whose three vertices lie on a point or line exactly: left out
    double surface_area_cost = 0;        // expected node and leaf-block visits of a random ray, SAH
    int depth = 0;
    double seconds = 0;
};

/// nodes[0] is the root; empty when there is nothing to hit. All arrays are ready for upload.
struct Bvh {
    std::vector<BvhNode> nodes;
    std::vector<TriangleBlock> triangle_blocks;
    std::vector<SphereBlock> sphere_blocks;
    Bounds bounds;
    BvhStatistics statistics;
};

struct BvhOptions {
    unsigned threads = 0;  // 0: all cores
};

/// Builds over triangles (primitive id = index) and spheres (id = triangles.size() + index).
/// The result does not depend on the number of threads.
Bvh build_bvh(std::span<const Vertex> vertices, std::span<const Triangle> triangles, std::span<const Sphere> spheres,
              const BvhOptions& options = {});

}  // namespace raymill
