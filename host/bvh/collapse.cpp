#include "bvh/collapse.hpp"

#include <algorithm>
#include <cmath>

namespace raymill::bvh {
namespace {

double leaf_cost(double half_area, std::uint32_t count) {
    return half_area * LEAF_BLOCK_COST * ((count + BVH_WIDTH - 1) / BVH_WIDTH);
}

struct Distribution {
    double cost = INFINITY;
    int left = 0;
};

/// The cheapest way to share `roots` out between two children, each getting at least one.
Distribution distribute(int roots, const SubtreeCost& left, const SubtreeCost& right) {
    Distribution best;
    for (int i = 1; i < roots; ++i) {
        const double cost = left.forest[i] + right.forest[roots - i];
        // Strict but for the first: costs beyond the largest double are no reason to choose nothing.
        if (cost < best.cost || best.left == 0) best = {cost, i};
    }
    return best;
}

}  // namespace

SubtreeCost collapse_leaf(double half_area, std::uint32_t count, bool spheres, CollapseChoice& choice) {
    SubtreeCost result;
    result.forest.fill(leaf_cost(half_area, count));
    result.has_spheres = spheres;
    result.has_triangles = !spheres;
    choice = {};
    choice.set_leaf();
    return result;
}

SubtreeCost collapse_inner(double half_area, std::uint32_t count, const SubtreeCost& left, const SubtreeCost& right,
                           CollapseChoice& choice) {
    SubtreeCost result;
    result.height = std::max(left.height, right.height) + 1;
    result.has_triangles = left.has_triangles || right.has_triangles;
    result.has_spheres = left.has_spheres || right.has_spheres;
    choice = {};
    choice.set_height(result.height);

    const Distribution children = distribute(BVH_WIDTH, left, right);
    choice.set_left_roots(BVH_WIDTH, children.left);
    result.forest[1] = half_area * NODE_COST + children.cost;
    const bool may_be_leaf = count <= MAX_LEAF_SIZE && !(result.has_triangles && result.has_spheres);
    if (may_be_leaf && leaf_cost(half_area, count) <= result.forest[1]) {
        choice.set_leaf();
        result.forest[1] = leaf_cost(half_area, count);
    }
    for (int roots = 2; roots < BVH_WIDTH; ++roots) {
        const Distribution shared = distribute(roots, left, right);
        result.forest[roots] = std::min(result.forest[roots - 1], shared.cost);
        if (shared.cost < result.forest[roots - 1]) choice.set_left_roots(roots, shared.left);
    }
    return result;
}

}  // namespace raymill::bvh
