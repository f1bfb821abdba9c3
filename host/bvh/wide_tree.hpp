// From the binary tree to the arrays that the kernels read.
#pragma once

#include "bvh/binary_tree.hpp"
#include "bvh/bvh.hpp"

namespace raymill::bvh {

/// Fills nodes, blocks, bounds, cost and depth of `result`. The children of a node are adjacent, subtrees follow depth
/// first, leaf blocks come in the order in which their nodes do.
/// Throws std::length_error if there are more leaf blocks than a child word can name (2^27 of a kind).
void collapse_to_wide(const BinaryTree& tree, std::span<const Vertex> vertices, std::span<const Triangle> triangles,
                      std::span<const Sphere> spheres, Bvh& result);

}  // namespace raymill::bvh
