// What the tree is built over: a primitive's bounds and its id, in 32 bytes.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "bvh/box.hpp"
#include "bvh/bvh.hpp"
#include "bvh/large_array.hpp"

namespace raymill::bvh {

/// Bounds of a primitive. Lane 3 of `lower_and_id` holds the bits of its id, lane 3 of `upper` is zero.
struct PrimitiveRef {
    Float4 lower_and_id;
    Float4 upper;

    std::uint32_t id() const { return std::bit_cast<std::uint32_t>(static_cast<float>(lower_and_id[3])); }
    Box box() const { return {xyz(lower_and_id), upper}; }
    /// Half the centroid. Any multiple orders alike; of this one even the differences stay below the largest float.
    Float4 half_centroid() const { return xyz(lower_and_id) * splat(0.25f) + upper * splat(0.25f); }
};
static_assert(sizeof(PrimitiveRef) == 32);

/// References in the order of their ids.
struct PrimitiveRefs {
    LargeArray<PrimitiveRef> refs;
    std::size_t dropped_not_finite = 0;
    std::size_t dropped_zero_area = 0;
};

/// Bounds of all primitives that a ray can hit, exact for triangles and rounded outward for spheres. The id of a
/// sphere is triangles.size() + its index. Asserts that triangles name existing vertices.
PrimitiveRefs make_primitive_refs(std::span<const Vertex> vertices, std::span<const Triangle> triangles,
                                  std::span<const Sphere> spheres);

}  // namespace raymill::bvh
