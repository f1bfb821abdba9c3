// Which binary nodes become eight-wide ones: dynamic programming over the binary tree that minimises the SAH cost.
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"
// (HPG 2017), section 3.1. C(n, i) there is SubtreeCost::forest[i] here: the least cost of representing the subtree
// of n as at most i children of wide nodes above it.
#pragma once

#include <array>
#include <cstdint>

#include "layout.h"

namespace raymill::bvh {

inline constexpr int MAX_LEAF_BLOCKS = CHILD_BLOCKS_MASK + 1;
inline constexpr std::uint32_t MAX_LEAF_SIZE = MAX_LEAF_BLOCKS * BVH_WIDTH;

/// Time of one visit during traversal, relative to each other. Measured as that of whole traversals by single random
/// rays (AVX2, four meshes): within noise for a block cost of 0.5 to 1.5; at 0.25 up to 40% and at 3 up to 30% slower.
inline constexpr double NODE_COST = 1.0;
inline constexpr double LEAF_BLOCK_COST = 0.7;

/// The decisions at a binary node, packed, and its height over the lowest binary leaf.
class CollapseChoice {
  public:
    /// In a forest of `roots` (2 to BVH_WIDTH) from this subtree, how many come from the left child; 0: fewer roots
    /// do as well. For BVH_WIDTH, the children of the wide node that this node becomes, it is never 0.
    int left_roots(int roots) const { return static_cast<int>(word_ >> shift(roots) & 7u); }
    void set_left_roots(int roots, int left) { word_ |= static_cast<std::uint32_t>(left) << shift(roots); }

    /// As a single root: a leaf, else a wide node.
    bool is_leaf() const { return (word_ & LEAF_BIT) != 0; }
    void set_leaf() { word_ |= LEAF_BIT; }

    int height() const { return static_cast<int>(word_ >> HEIGHT_SHIFT); }
    void set_height(int height) { word_ |= static_cast<std::uint32_t>(height) << HEIGHT_SHIFT; }

  private:
    static constexpr std::uint32_t LEAF_BIT = 1u << 21;
    static constexpr int HEIGHT_SHIFT = 24;
    static int shift(int roots) { return 3 * (roots - 2); }
    std::uint32_t word_;  // not initialised: arrays of nodes are touched first by the thread that fills them
};

/// What a parent needs to know of a binary subtree to decide.
struct SubtreeCost {
    std::array<double, BVH_WIDTH> forest;  // [i]: at most i roots; [0] is unused
    int height = 0;
    bool has_triangles = false;
    bool has_spheres = false;
};

/// Cost of a binary leaf; all its primitives are of one kind and at most MAX_LEAF_SIZE.
SubtreeCost collapse_leaf(double half_area, std::uint32_t count, bool spheres, CollapseChoice& choice);

/// Cost and choice of a binary node with these children.
SubtreeCost collapse_inner(double half_area, std::uint32_t count, const SubtreeCost& left, const SubtreeCost& right,
                           CollapseChoice& choice);

}  // namespace raymill::bvh
