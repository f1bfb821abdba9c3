// The binary tree over primitive references, built from the top in parallel; collapse.hpp decides on the way up what
// becomes of it.
#pragma once

#include <cstddef>

#include "bvh/collapse.hpp"
#include "bvh/primitive_refs.hpp"

namespace raymill::bvh {

/// No path is longer. collapse_to_wide turns three binary levels into a wide one where it must.
inline constexpr int MAX_BINARY_HEIGHT = 3 * BVH_MAX_DEPTH;

/// A subtree of n primitives owns 2n - 1 consecutive places: itself, its left subtree, its right subtree. So the tree
/// needs no pointers, and no two threads ever ask for the same place.
struct BinaryNode {
    float lower[3];
    std::uint32_t count;  // primitives below
    float upper[3];
    CollapseChoice choice;

    bool is_leaf() const { return choice.height() == 0; }
};
static_assert(sizeof(BinaryNode) == 32);

inline std::size_t left_child(std::size_t node) {
    return node + 1;
}
inline std::size_t right_child(const BinaryNode* nodes, std::size_t node) {
    return node + 2 * static_cast<std::size_t>(nodes[node + 1].count);
}

struct BinaryTree {
    LargeArray<BinaryNode> nodes;   // [0] is the root
    LargeArray<PrimitiveRef> refs;  // in the order of the leaves
};

/// Consumes the references; there must be one at least. Ids from triangle_count on are spheres. Runs in the caller's
/// task arena; the result does not depend on its size.
BinaryTree build_binary_tree(PrimitiveRefs refs, std::uint32_t triangle_count);

}  // namespace raymill::bvh
