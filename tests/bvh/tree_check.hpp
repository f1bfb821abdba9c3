// Walks a whole tree and compares it with the geometry it was built from and with the rules of layout.h.
#pragma once

#include <vector>

#include "bvh/bvh.hpp"
#include "meshes.hpp"

namespace raymill::test {

/// What a walk found; violations of the layout's rules are reported as test failures on the way.
struct TreeFacts {
    std::vector<int> occurrences;  // of each primitive id
    double surface_area_cost = 0;  // computed anew from the boxes
    int depth = 0;
};

/// Checks: nodes and blocks are each used once, siblings are adjacent, empty slots and unused lanes are as agreed,
/// lanes hold the geometry bit for bit, every box encloses what is below it, leaves are of one kind; that depth, cost
/// and bounds in the tree are those found; and that depth keeps to BVH_MAX_DEPTH.
TreeFacts check_tree(const Mesh& mesh, const Bvh& bvh);

/// check_tree, and every primitive occurs exactly once.
void expect_complete_tree(const Mesh& mesh, const Bvh& bvh);

/// expect_complete_tree on those of both qualities.
void expect_complete_trees(const Mesh& mesh);

}  // namespace raymill::test
