#include "bvh/binary_tree.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include "bvh/binned_split.hpp"

namespace raymill::bvh {
namespace {

constexpr std::size_t PARALLEL_SIZE = 2048;  // shorter ranges are one task

/// A subtree to build: its node, its primitives [begin, begin + count) in one of the two buffers, and their bounds.
struct Task {
    std::size_t node = 0;
    std::size_t begin = 0;
    std::size_t count = 0;
    int depth = 0;
    int buffer = 0;
    RangeBounds bounds;

    Task left(std::size_t left_count, int child_buffer, const RangeBounds& child_bounds) const {
        return {node + 1, begin, left_count, depth + 1, child_buffer, child_bounds};
    }
    Task right(std::size_t left_count, int child_buffer, const RangeBounds& child_bounds) const {
        return {node + 2 * left_count, begin + left_count, count - left_count, depth + 1, child_buffer, child_bounds};
    }
};

std::size_t leaf_blocks(std::size_t count) {
    return (count + BVH_WIDTH - 1) / BVH_WIDTH;
}

/// Height of a subtree that is halved block by block, one level for splitting by kind included.
int balanced_height(std::size_t count) {
    return static_cast<int>(std::bit_width(leaf_blocks(count) - 1)) + 1;
}

class Builder {
  public:
    Builder(PrimitiveRef* result, PrimitiveRef* scratch, BinaryNode* nodes, std::uint32_t triangle_count)
        : buffers_{result, scratch}, nodes_(nodes), triangle_count_(triangle_count) {}

    SubtreeCost build(const Task& task) {
        const std::span<PrimitiveRef> refs(buffers_[task.buffer] + task.begin, task.count);
        BinaryNode& node = nodes_[task.node];
        for (int axis = 0; axis < 3; ++axis) {
            node.lower[axis] = task.bounds.box.lower[axis];
            node.upper[axis] = task.bounds.box.upper[axis];
        }
        node.count = static_cast<std::uint32_t>(task.count);
        const double area = half_area(node.lower, node.upper);

        // Below this point only halving keeps the promised height. Each halving lowers balanced_height by one.
        const bool must_halve = task.depth + balanced_height(task.count) >= MAX_BINARY_HEIGHT;
        // A leaf block costs the same however full it is: splitting one's worth gains little, and takes time.
        if (task.count <= BVH_WIDTH && is_one_kind(refs)) return make_leaf(task, refs, area, node.choice);

        const auto [left, right] = must_halve ? halve(task, refs) : split(task, refs);
        SubtreeCost left_cost, right_cost;
        if (task.count < PARALLEL_SIZE) {
            left_cost = build(left);
            right_cost = build(right);
        } else {
            tbb::parallel_invoke([&] { left_cost = build(left); }, [&] { right_cost = build(right); });
        }
        return collapse_inner(area, node.count, left_cost, right_cost, node.choice);
    }

  private:
    using Tasks = std::pair<Task, Task>;

    bool is_sphere(const PrimitiveRef& ref) const { return ref.id() >= triangle_count_; }

    bool is_one_kind(std::span<const PrimitiveRef> refs) const {
        return std::all_of(refs.begin(), refs.end(), [&](auto& ref) { return is_sphere(ref) == is_sphere(refs[0]); });
    }

    SubtreeCost make_leaf(const Task& task, std::span<const PrimitiveRef> refs, double area, CollapseChoice& choice) {
        assert(task.depth <= MAX_BINARY_HEIGHT);
        if (task.buffer != 0) std::copy(refs.begin(), refs.end(), buffers_[0] + task.begin);
        return collapse_leaf(area, static_cast<std::uint32_t>(task.count), is_sphere(refs[0]), choice);
    }

    /// By surface area where centroids differ, else by kind or index.
    Tasks split(const Task& task, std::span<PrimitiveRef> refs) {
        const BinGrid grid(task.bounds.half_centroids, bin_count(task.count));
        const auto found = find_split(refs, task.bounds.box, grid);
        if (!found) return halve(task, refs);
        const int target = 1 - task.buffer;
        const Halves halves = partition(refs, buffers_[target] + task.begin, grid, *found);
        return {task.left(found->left_count, target, halves.left), task.right(found->left_count, target, halves.right)};
    }

    /// At the median centroid of the longest axis, in whole leaf blocks; equal centroids by index. A single block's
    /// worth is split by kind if there are two.
    Tasks halve(const Task& task, std::span<PrimitiveRef> refs) {
        std::size_t left_count = 0;
        if (task.count <= BVH_WIDTH && !is_one_kind(refs)) {
            const auto middle = std::stable_partition(refs.begin(), refs.end(), [&](auto& r) { return !is_sphere(r); });
            left_count = static_cast<std::size_t>(middle - refs.begin());
        } else {
            left_count = split_at_median(refs, task.bounds.half_centroids);
        }
        return {task.left(left_count, task.buffer, measure(refs.first(left_count))),
                task.right(left_count, task.buffer, measure(refs.subspan(left_count)))};
    }

    static std::size_t split_at_median(std::span<PrimitiveRef> refs, const Box& half_centroids) {
        const Float4 extent = half_centroids.upper - half_centroids.lower;
        const int axis = extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : extent[1] >= extent[2] ? 1 : 2;
        const std::size_t in_blocks = (leaf_blocks(refs.size()) + 1) / 2 * BVH_WIDTH;
        const std::size_t left_count = in_blocks < refs.size() ? in_blocks : refs.size() / 2;
        std::nth_element(refs.begin(), refs.begin() + static_cast<std::ptrdiff_t>(left_count), refs.end(),
                         [axis](const PrimitiveRef& a, const PrimitiveRef& b) {
                             const float ca = a.half_centroid()[axis], cb = b.half_centroid()[axis];
                             return ca != cb ? ca < cb : a.id() < b.id();
                         });
        return left_count;
    }

    PrimitiveRef* buffers_[2];
    BinaryNode* nodes_;
    std::uint32_t triangle_count_;
};

}  // namespace

BinaryTree build_binary_tree(PrimitiveRefs refs, std::uint32_t triangle_count) {
    assert(!refs.refs.empty());
    LargeArray<PrimitiveRef> scratch(refs.refs.size());
    BinaryTree tree;
    tree.refs = std::move(refs.refs);
    tree.nodes.resize(2 * tree.refs.size() - 1);
    const Task all{.count = tree.refs.size(), .bounds = measure(tree.refs)};
    Builder(tree.refs.data(), scratch.data(), tree.nodes.data(), triangle_count).build(all);
    return tree;
}

}  // namespace raymill::bvh
