// Improves a binary tree: takes subtrees out and puts them in where they enlarge the boxes least.
// Source: Meister, Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", Computer Graphics Forum
// 37(2), 2018. Deviations: of each round only the subtrees with the largest boxes are searched for, as they have most
// to gain, and the moves are made one after the other, so that the result does not depend on threads.
#pragma once

#include "bvh/binary_tree.hpp"

namespace raymill::bvh {

/// The same leaves in a tree of less surface area, as long as rounds gain something to speak of; the tree itself if
/// none does, or if the new one would be higher than MAX_BINARY_HEIGHT. Runs in the caller's task arena; the result
/// does not depend on its size.
BinaryTree reinsert(BinaryTree tree, std::uint32_t triangle_count);

}  // namespace raymill::bvh
