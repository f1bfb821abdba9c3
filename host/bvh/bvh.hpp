// The bounding volume hierarchy: eight children a node, leaves of eight triangles or spheres as structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "bvh/large_array.hpp"
#include "layout.h"

namespace raymill {

/// An axis-aligned box; empty while lower > upper.
struct Bounds {
    glm::vec3 lower{INFINITY};
    glm::vec3 upper{-INFINITY};
};

/// Levels of nodes on any path from the root to a leaf are at most this many, whatever the input. A traversal that
/// pushes up to BVH_WIDTH - 1 children a level never holds more than BVH_STACK_SIZE of them.
inline constexpr int BVH_MAX_DEPTH = 32;
inline constexpr int BVH_STACK_SIZE = BVH_MAX_DEPTH * (BVH_WIDTH - 1) + 1;

struct BvhStatistics {
    std::size_t dropped_not_finite = 0;  // primitives with a NaN or infinite coordinate: left out
    std::size_t dropped_zero_area = 0;   // triangles whose vertices lie on a point or line exactly, spheres without
                                         // a positive radius: left out
    double surface_area_cost = 0;        // expected node and leaf-block visits of a random ray, SAH
    int depth = 0;                       // levels of nodes: 1 if the root has leaves alone
    double seconds = 0;                  // wall-clock time of the whole build
};

/// nodes[0] is the root; empty when there is nothing to hit. All arrays are ready for upload.
struct Bvh {
    bvh::LargeArray<BvhNode> nodes;
    bvh::LargeArray<TriangleBlock> triangle_blocks;
    bvh::LargeArray<SphereBlock> sphere_blocks;
    Bounds bounds;
    BvhStatistics statistics;
};

struct BvhOptions {
    unsigned threads = 0;  // 0: all cores
};

/// Builds over triangles (primitive id = index) and spheres (id = triangles.size() + index).
/// The result does not depend on the number of threads. Asserts that triangles name existing vertices.
/// Throws std::length_error if there are more leaf blocks than a child word can name (2^27 of a kind).
/// Sources: binned SAH (Wald 2007) and a collapse to eight children by dynamic programming (Ylitie et al. 2017).
Bvh build_bvh(std::span<const Vertex> vertices, std::span<const Triangle> triangles, std::span<const Sphere> spheres,
              const BvhOptions& options = {});

}  // namespace raymill
