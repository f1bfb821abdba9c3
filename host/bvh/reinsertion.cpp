#include "bvh/reinsertion.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace raymill::bvh {
namespace {

// Two to seven times the searches saved diffuse rays at most 2% of their visits, on four kinds of scenes, and not
// always.
constexpr int ROUNDS = 8;
constexpr double LEAST_GAIN = 1e-4;          // of the area of all boxes: a round that gains no more is the last
constexpr std::size_t SEARCHED_SHARE = 10;   // one of so many nodes a round
constexpr std::size_t PARALLEL_SIZE = 2048;  // shorter ranges are one task

using Index = std::uint32_t;
constexpr Index ROOT = 0;

/// Siblings are neighbours, at 2k + 1 and 2k + 2. Boxes are in units of the root's largest edge: they decide what moves
/// where, and nothing else depends on them, so rounding does no harm.
struct LinkedNode {
    Float4 lower;
    Float4 upper;
    Index first;  // of an inner node its first child, of a leaf its first primitive
    Index parent;
    Index count;  // primitives of a leaf; 0 of an inner node
    float area;

    bool is_leaf() const { return count != 0; }
};

Index sibling_of(Index node) {
    return node % 2 == 1 ? node + 1 : node - 1;
}

float half_area(Float4 lower, Float4 upper) {
    const Float4 e = upper - lower;
    const Float4 products = e * __builtin_shuffle(e, Int4{1, 2, 0, 3});
    return products[0] + products[1] + products[2];
}

/// Taking `node` out and putting it in beside `target` makes the tree's boxes smaller by `gain`.
struct Move {
    Index node = 0;
    Index target = 0;
    float gain = 0;
};

class LinkedTree {
  public:
    explicit LinkedTree(const BinaryTree& tree) {
        const BinaryNode& root = tree.nodes[0];
        float edge = 0;
        for (int axis = 0; axis < 3; ++axis) edge = std::max(edge, 0.5f * root.upper[axis] - 0.5f * root.lower[axis]);
        scale_ = splat(0.5f / std::max(edge, 1e-37f));
        nodes_.emplace_back().parent = ROOT;
        link(ROOT, tree.nodes.data(), 0, 0);
    }

    std::size_t size() const { return nodes_.size(); }
    const LinkedNode& operator[](Index node) const { return nodes_[node]; }

    /// Of all boxes.
    double area() const {
        return std::accumulate(nodes_.begin(), nodes_.end(), 0.0,
                               [](double sum, const LinkedNode& node) { return sum + node.area; });
    }

    /// One round: searches for all moves, then makes those that do not get in each other's way, the best first.
    /// Returns what the searches promised of them.
    double improve() {
        std::vector<Move> moves = find_moves(candidates(nodes_.size() / SEARCHED_SHARE));
        std::erase_if(moves, [](const Move& move) { return move.gain <= 0; });
        std::sort(moves.begin(), moves.end(),
                  [](const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.node < b.node; });
        std::vector<bool> touched(nodes_.size());
        double gain = 0;
        for (const Move& move : moves) {
            const Index involved[] = {move.node, move.target, sibling_of(move.node), nodes_[move.node].parent,
                                      nodes_[move.target].parent};
            if (std::any_of(std::begin(involved), std::end(involved), [&](Index i) { return touched[i]; })) continue;
            if (is_below(move.target, move.node)) continue;  // by an earlier move of this round
            for (const Index i : involved) touched[i] = true;
            apply(move);
            gain += move.gain;
        }
        return gain;
    }

  private:
    /// Copies the subtree at `from` of a tree, whose first primitive is `begin`, to `to`.
    void link(Index to, const BinaryNode* tree, std::size_t from, Index begin) {
        const BinaryNode& node = tree[from];
        nodes_[to].lower = Float4{node.lower[0], node.lower[1], node.lower[2], 0} * scale_;
        nodes_[to].upper = Float4{node.upper[0], node.upper[1], node.upper[2], 0} * scale_;
        nodes_[to].area = half_area(nodes_[to].lower, nodes_[to].upper);
        if (node.is_leaf()) {
            nodes_[to].count = node.count;
            nodes_[to].first = begin;
            return;
        }
        const auto first = static_cast<Index>(nodes_.size());
        nodes_.resize(nodes_.size() + 2);
        nodes_[to].count = 0;
        nodes_[to].first = first;
        nodes_[first].parent = nodes_[first + 1].parent = to;
        const std::size_t left = left_child(from);
        link(first, tree, left, begin);
        link(first + 1, tree, right_child(tree, from), begin + tree[left].count);
    }

    /// Those with the largest boxes, the root aside.
    std::vector<Index> candidates(std::size_t count) const {
        std::vector<std::pair<float, Index>> all;
        all.reserve(nodes_.size() - 1);
        for (Index node = ROOT + 1; node < nodes_.size(); ++node) all.emplace_back(-nodes_[node].area, node);
        std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), all.end());
        std::vector<Index> largest(count);
        std::transform(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), largest.begin(),
                       [](const auto& entry) { return entry.second; });
        return largest;
    }

    std::vector<Move> find_moves(const std::vector<Index>& searched) const {
        std::vector<Move> moves(searched.size());
        tbb::parallel_for(std::size_t{0}, searched.size(), [&](std::size_t i) { moves[i] = find_move(searched[i]); });
        return moves;
    }

    Move find_move(Index node) const;

    bool is_below(Index node, Index ancestor) const {
        for (; node != ROOT; node = nodes_[node].parent)
            if (node == ancestor) return true;
        return false;
    }

    void apply(const Move& move);

    void set_children_parent(Index node) {
        if (nodes_[node].is_leaf()) return;
        nodes_[nodes_[node].first].parent = node;
        nodes_[nodes_[node].first + 1].parent = node;
    }

    /// Boxes from an inner node up to the root.
    void refit(Index node) {
        for (;; node = nodes_[node].parent) {
            LinkedNode& n = nodes_[node];
            const LinkedNode &a = nodes_[n.first], &b = nodes_[n.first + 1];
            n.lower = min(a.lower, b.lower);
            n.upper = max(a.upper, b.upper);
            n.area = half_area(n.lower, n.upper);
            if (node == ROOT) return;
        }
    }

    LargeArray<LinkedNode> nodes_;
    Float4 scale_;
};

/// The best place for the subtree of `node`: from its parent upwards, whatever hangs beside the way.
Move LinkedTree::find_move(Index node) const {
    struct Open {
        float saved;  // area saved above this subtree, if the node goes into it
        Index node;
    };
    constexpr int STACK_SIZE = 256;
    Open stack[STACK_SIZE];
    const LinkedNode& moved = nodes_[node];
    Move best{node, 0, 0};
    const Index parent = moved.parent;
    float saved = nodes_[parent].area;
    Index side = sibling_of(node), pivot = parent;
    Float4 lower = nodes_[side].lower, upper = nodes_[side].upper;  // of the pivot without the node
    for (;;) {
        int open = 0;
        stack[open++] = {saved, side};
        while (open > 0) {
            const Open top = stack[--open];
            if (top.saved - moved.area <= best.gain) continue;
            const LinkedNode& target = nodes_[top.node];
            const float gain = top.saved - half_area(min(target.lower, moved.lower), max(target.upper, moved.upper));
            if (gain > best.gain && top.node != sibling_of(node)) best = {node, top.node, gain};
            if (target.is_leaf() || open + 2 > STACK_SIZE) continue;  // deeper places are not worth a larger stack
            const float below = gain + target.area;
            if (below - moved.area <= best.gain) continue;
            stack[open++] = {below, target.first};
            stack[open++] = {below, target.first + 1};
        }
        if (pivot == ROOT) break;
        if (pivot != parent) {
            lower = min(lower, nodes_[side].lower);
            upper = max(upper, nodes_[side].upper);
            saved += nodes_[pivot].area - half_area(lower, upper);
        }
        side = sibling_of(pivot);
        pivot = nodes_[pivot].parent;
    }
    return best;
}

/// The sibling takes the parent's place, the target the sibling's, and a new parent of both the target's.
void LinkedTree::apply(const Move& move) {
    const Index sibling = sibling_of(move.node), parent = nodes_[move.node].parent;
    const Index target = move.target;
    assert(target != sibling && target != parent);
    const Index grandparent = nodes_[parent].parent;

    nodes_[parent] = nodes_[sibling];
    nodes_[parent].parent = grandparent;
    set_children_parent(parent);

    const Index above = nodes_[target].parent;  // only now: it may have been the sibling
    nodes_[sibling] = nodes_[target];
    nodes_[sibling].parent = target;
    set_children_parent(sibling);

    nodes_[target].count = 0;
    nodes_[target].first = std::min(move.node, sibling);
    nodes_[target].parent = above;
    nodes_[move.node].parent = target;

    if (parent != ROOT) refit(grandparent);
    refit(target);
}

/// Writes a linked tree over the one that it was made from.
class Writer {
  public:
    Writer(BinaryTree& tree, const LinkedTree& linked, std::uint32_t triangle_count)
        : tree_(tree), linked_(linked), triangle_count_(triangle_count) {
        counts_.resize(linked.size());
        height_ = count(ROOT, 0);
    }

    bool fits() const { return height_ <= MAX_BINARY_HEIGHT; }

    void write() {
        refs_.resize(tree_.refs.size());
        write(ROOT, 0, 0);
        tree_.refs = std::move(refs_);
    }

  private:
    /// Fills in the number of primitives below each node; returns the height. Both end where the tree is too high.
    int count(Index node, int depth) {
        const LinkedNode& n = linked_[node];
        if (n.is_leaf()) {
            counts_[node] = n.count;
            return 0;
        }
        if (depth > MAX_BINARY_HEIGHT) return 1;
        const int height = std::max(count(n.first, depth + 1), count(n.first + 1, depth + 1)) + 1;
        counts_[node] = counts_[n.first] + counts_[n.first + 1];
        return height;
    }

    /// The subtree at `from`, its first primitive at `begin`.
    SubtreeCost write(Index from, std::size_t to, std::size_t begin) {
        const LinkedNode& linked = linked_[from];
        BinaryNode& node = tree_.nodes[to];
        node.count = counts_[from];
        if (linked.is_leaf()) {
            const std::span<const PrimitiveRef> refs(&tree_.refs[linked.first], node.count);
            std::ranges::copy(refs, &refs_[begin]);
            Box box;
            for (const PrimitiveRef& ref : refs) box.add(ref.box());
            for (int axis = 0; axis < 3; ++axis) {
                node.lower[axis] = box.lower[axis];
                node.upper[axis] = box.upper[axis];
            }
            return collapse_leaf(bvh::half_area(node.lower, node.upper), node.count, refs[0].id() >= triangle_count_,
                                 node.choice);
        }
        const Index left = linked.first, right = left + 1;
        const std::size_t left_to = to + 1, right_to = to + 2 * static_cast<std::size_t>(counts_[left]);
        SubtreeCost left_cost, right_cost;
        const auto write_left = [&] { left_cost = write(left, left_to, begin); };
        const auto write_right = [&] { right_cost = write(right, right_to, begin + counts_[left]); };
        if (counts_[from] < PARALLEL_SIZE) {
            write_left();
            write_right();
        } else {
            tbb::parallel_invoke(write_left, write_right);
        }
        const BinaryNode &a = tree_.nodes[left_to], &b = tree_.nodes[right_to];
        for (int axis = 0; axis < 3; ++axis) {
            node.lower[axis] = std::min(a.lower[axis], b.lower[axis]);
            node.upper[axis] = std::max(a.upper[axis], b.upper[axis]);
        }
        return collapse_inner(bvh::half_area(node.lower, node.upper), node.count, left_cost, right_cost, node.choice);
    }

    BinaryTree& tree_;
    const LinkedTree& linked_;
    std::uint32_t triangle_count_;
    std::vector<Index> counts_;
    int height_ = 0;
    LargeArray<PrimitiveRef> refs_;
};

}  // namespace

BinaryTree reinsert(BinaryTree tree, std::uint32_t triangle_count) {
    LinkedTree linked(tree);
    const double least_gain = LEAST_GAIN * linked.area();
    double gain = 0;
    for (int round = 0; round < ROUNDS; ++round) {
        const double gain_of_round = linked.improve();
        gain += gain_of_round;
        if (gain_of_round <= least_gain) break;
    }
    if (gain == 0) return tree;
    Writer writer(tree, linked, triangle_count);
    if (writer.fits()) writer.write();
    return tree;
}

}  // namespace raymill::bvh
