#include "bvh/wide_tree.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <stdexcept>

namespace raymill::bvh {
namespace {

/// A subtree of the binary tree: its root, and its first primitive.
struct Subtree {
    std::size_t node = 0;
    std::size_t begin = 0;
};

/// The roots that become the children of a wide node.
struct Roots {
    Subtree root[BVH_WIDTH];
    int count = 0;

    void add(const Subtree& subtree) { root[count++] = subtree; }
};

/// A leaf whose blocks are still to be filled.
struct Leaf {
    std::size_t begin = 0;
    std::uint32_t count = 0;
    std::uint32_t first_block = 0;
    bool spheres = false;
};

std::uint32_t leaf_blocks(std::uint32_t count) {
    return (count + BVH_WIDTH - 1) / BVH_WIDTH;
}

BvhNode empty_node() {
    BvhNode node{};
    for (int axis = 0; axis < 3; ++axis)
        for (int slot = 0; slot < BVH_WIDTH; ++slot) {
            node.bounds[0][axis][slot] = INFINITY;
            node.bounds[1][axis][slot] = -INFINITY;
        }
    return node;
}

/// Lays out wide nodes and leaves in the order of a walk through the binary tree.
class Layout {
  public:
    Layout(const BinaryTree& tree, std::uint32_t triangle_count, LargeArray<BvhNode>& nodes)
        : tree_(tree), nodes_(nodes), triangle_count_(triangle_count) {}

    void run() {
        nodes_.push_back(empty_node());
        const Subtree root;
        if (node(root).choice.is_leaf()) {
            Roots only;
            only.add(root);
            cost_ += area(root);
            depth_ = 1;
            set_leaf(0, 0, root);
        } else {
            lay_out(0, root, 1);
        }
    }

    const std::vector<Leaf>& leaves() const { return leaves_; }
    std::size_t triangle_blocks() const { return triangle_blocks_; }
    std::size_t sphere_blocks() const { return sphere_blocks_; }
    int depth() const { return depth_; }
    double cost() const { return area(Subtree{}) > 0 ? cost_ / area(Subtree{}) : 0; }

  private:
    const BinaryNode& node(const Subtree& subtree) const { return tree_.nodes[subtree.node]; }
    double area(const Subtree& subtree) const { return half_area(node(subtree).lower, node(subtree).upper); }
    Subtree left(const Subtree& s) const { return {left_child(s.node), s.begin}; }
    Subtree right(const Subtree& s) const {
        const std::size_t right_node = right_child(tree_.nodes.data(), s.node);
        return {right_node, s.begin + tree_.nodes[left_child(s.node)].count};
    }

    /// Depth d counts from 1. Three binary levels a wide level always fit: this is the invariant that keeps the
    /// promise of BVH_MAX_DEPTH.
    bool fits(const Subtree& s, int depth) const {
        return node(s).choice.is_leaf() || (node(s).choice.height() + 2) / 3 <= BVH_MAX_DEPTH - depth + 1;
    }

    /// The wide node `index` stands for the inner binary node `subtree`.
    void lay_out(std::size_t index, const Subtree& subtree, int depth) {
        assert(depth <= BVH_MAX_DEPTH);
        depth_ = std::max(depth_, depth);
        cost_ += area(subtree);
        const Roots roots = choose_roots(subtree, depth);
        const std::size_t first_child = nodes_.size();
        std::size_t inner = 0;
        for (int slot = 0; slot < roots.count; ++slot) {
            if (node(roots.root[slot]).choice.is_leaf())
                set_leaf(index, slot, roots.root[slot]);
            else
                set_inner(index, slot, roots.root[slot], first_child + inner++);
        }
        nodes_.resize(first_child + inner, empty_node());
        inner = 0;
        for (int slot = 0; slot < roots.count; ++slot)
            if (!node(roots.root[slot]).choice.is_leaf()) lay_out(first_child + inner++, roots.root[slot], depth + 1);
    }

    Roots choose_roots(const Subtree& subtree, int depth) const {
        Roots roots;
        const int left_roots = node(subtree).choice.left_roots(BVH_WIDTH);
        collect(left(subtree), left_roots, roots);
        collect(right(subtree), BVH_WIDTH - left_roots, roots);
        if (std::all_of(roots.root, roots.root + roots.count, [&](auto& root) { return fits(root, depth + 1); }))
            return roots;
        roots.count = 0;
        collect_levels(left(subtree), 2, roots);
        collect_levels(right(subtree), 2, roots);
        return roots;
    }

    /// The cheapest forest of at most `count` roots.
    void collect(const Subtree& subtree, int count, Roots& roots) const {
        const CollapseChoice choice = node(subtree).choice;
        while (count > 1 && choice.left_roots(count) == 0) --count;
        if (count == 1) return roots.add(subtree);
        const int left_roots = choice.left_roots(count);
        collect(left(subtree), left_roots, roots);
        collect(right(subtree), count - left_roots, roots);
    }

    /// All subtrees `levels` further down.
    void collect_levels(const Subtree& subtree, int levels, Roots& roots) const {
        if (levels == 0 || node(subtree).choice.is_leaf()) return roots.add(subtree);
        collect_levels(left(subtree), levels - 1, roots);
        collect_levels(right(subtree), levels - 1, roots);
    }

    void set_bounds(std::size_t index, int slot, const BinaryNode& child) {
        for (int axis = 0; axis < 3; ++axis) {
            nodes_[index].bounds[0][axis][slot] = child.lower[axis];
            nodes_[index].bounds[1][axis][slot] = child.upper[axis];
        }
    }

    void set_inner(std::size_t index, int slot, const Subtree& child, std::size_t child_index) {
        assert(child_index < CHILD_LEAF);
        set_bounds(index, slot, node(child));
        nodes_[index].child[slot] = static_cast<std::uint32_t>(child_index);
    }

    void set_leaf(std::size_t index, int slot, const Subtree& child) {
        const std::uint32_t count = node(child).count;
        const std::uint32_t blocks = leaf_blocks(count);
        const bool spheres = tree_.refs[child.begin].id() >= triangle_count_;
        std::size_t& used = spheres ? sphere_blocks_ : triangle_blocks_;
        if (used + blocks > CHILD_FIRST_MASK)
            throw std::length_error("the scene has too many primitives for one BVH: at most 2^27 blocks of eight");
        const auto first = static_cast<std::uint32_t>(used);
        set_bounds(index, slot, node(child));
        nodes_[index].child[slot] =
            CHILD_LEAF | (spheres ? CHILD_SPHERES : 0u) | (blocks - 1) << CHILD_BLOCKS_SHIFT | first;
        leaves_.push_back({child.begin, count, first, spheres});
        used += blocks;
        cost_ += area(child) * blocks;
    }

    const BinaryTree& tree_;
    LargeArray<BvhNode>& nodes_;
    std::vector<Leaf> leaves_;
    std::uint32_t triangle_count_;
    std::size_t triangle_blocks_ = 0;
    std::size_t sphere_blocks_ = 0;
    double cost_ = 0;
    int depth_ = 0;
};

TriangleBlock triangle_block(std::span<const PrimitiveRef> refs, std::span<const Vertex> vertices,
                             std::span<const Triangle> triangles) {
    TriangleBlock block;
    for (std::size_t lane = 0; lane < BVH_WIDTH; ++lane) {
        // An unused lane repeats the first vertex of the first triangle three times.
        const bool used = lane < refs.size();
        const Triangle& triangle = triangles[refs[used ? lane : 0].id()];
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 3; ++axis)
                block.position[corner][axis][lane] = vertices[triangle.vertex[used ? corner : 0]].position[axis];
        block.primitive[lane] = used ? refs[lane].id() : NO_INDEX;
    }
    return block;
}

SphereBlock sphere_block(std::span<const PrimitiveRef> refs, std::span<const Sphere> spheres,
                         std::uint32_t triangle_count) {
    SphereBlock block;
    for (std::size_t lane = 0; lane < BVH_WIDTH; ++lane) {
        const bool used = lane < refs.size();
        const Sphere& sphere = spheres[refs[used ? lane : 0].id() - triangle_count];
        for (int axis = 0; axis < 3; ++axis) block.center[axis][lane] = sphere.center[axis];
        block.radius[lane] = used ? sphere.radius : 0.0f;
        block.primitive[lane] = used ? refs[lane].id() : NO_INDEX;
    }
    return block;
}

}  // namespace

void collapse_to_wide(const BinaryTree& tree, std::span<const Vertex> vertices, std::span<const Triangle> triangles,
                      std::span<const Sphere> spheres, Bvh& result) {
    const auto triangle_count = static_cast<std::uint32_t>(triangles.size());
    Layout layout(tree, triangle_count, result.nodes);
    layout.run();
    const BinaryNode& root = tree.nodes[0];
    result.bounds = {{root.lower[0], root.lower[1], root.lower[2]}, {root.upper[0], root.upper[1], root.upper[2]}};
    result.statistics.depth = layout.depth();
    result.statistics.surface_area_cost = layout.cost();

    result.triangle_blocks.resize(layout.triangle_blocks());
    result.sphere_blocks.resize(layout.sphere_blocks());
    tbb::parallel_for(std::size_t{0}, layout.leaves().size(), [&](std::size_t i) {
        const Leaf& leaf = layout.leaves()[i];
        for (std::uint32_t block = 0; block < leaf_blocks(leaf.count); ++block) {
            const std::uint32_t offset = block * BVH_WIDTH;
            const std::span<const PrimitiveRef> refs(&tree.refs[leaf.begin + offset],
                                                     std::min<std::size_t>(BVH_WIDTH, leaf.count - offset));
            if (leaf.spheres)
                result.sphere_blocks[leaf.first_block + block] = sphere_block(refs, spheres, triangle_count);
            else
                result.triangle_blocks[leaf.first_block + block] = triangle_block(refs, vertices, triangles);
        }
    });
}

}  // namespace raymill::bvh
