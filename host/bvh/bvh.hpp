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

    /// Of all arrays together.
    std::size_t bytes() const {
        return nodes.size() * sizeof(BvhNode) + triangle_blocks.size() * sizeof(TriangleBlock) +
               sphere_blocks.size() * sizeof(SphereBlock);
    }
};

/// What rays find does not depend on it. fast: binned splits alone. high: subtrees are then put in better places, which
/// takes half as long again, and saves up to half of the visits where objects of many sizes mix, nothing on even
/// meshes.
enum class BvhQuality { fast, high };

struct BvhOptions {
    unsigned threads = 0;  // 0: all cores
    BvhQuality quality = BvhQuality::high;
};

/// Builds over triangles (primitive id = index) and spheres (id = triangles.size() + index).
/// The result does not depend on the number of threads. Asserts that triangles name existing vertices.
/// Throws std::length_error if there are more leaf blocks than a child word can name (2^27 of a kind).
/// Sources: binned SAH (Wald 2007), reinsertion (Meister and Bittner 2018), and a collapse to eight children by dynamic
/// programming (Ylitie et al. 2017). Triangles are not split among leaves (Stich et al. 2009): what is found must not
/// depend on the hierarchy, so each hit must lie in every box above it. Where a ray grazes a triangle, the distance
/// found was seen to be off by a hundredth of the triangle's length, and the bound that hits are accepted by allows all
/// of it: a box about a part of the triangle would have to be that much wider than the part.
Bvh build_bvh(std::span<const Vertex> vertices, std::span<const Triangle> triangles, std::span<const Sphere> spheres,
              const BvhOptions& options = {});

}  // namespace raymill
