#include "tree_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace raymill::test {
namespace {

/// In double, so that the extent of a sphere is exact.
struct ExactBounds {
    glm::dvec3 lower{INFINITY};
    glm::dvec3 upper{-INFINITY};

    void add(const glm::dvec3& low, const glm::dvec3& high) {
        lower = glm::min(lower, low);
        upper = glm::max(upper, high);
    }
    bool encloses(const ExactBounds& other) const {
        return glm::all(glm::lessThanEqual(lower, other.lower)) && glm::all(glm::greaterThanEqual(upper, other.upper));
    }
    double area() const {
        const glm::dvec3 e = upper - lower;
        return e.x * e.y + e.y * e.z + e.z * e.x;
    }
};

class Walk {
  public:
    Walk(const Mesh& mesh, const Bvh& bvh)
        : mesh_(mesh),
          bvh_(bvh),
          node_uses_(bvh.nodes.size()),
          triangle_block_uses_(bvh.triangle_blocks.size()),
          sphere_block_uses_(bvh.sphere_blocks.size()) {
        facts_.occurrences.resize(mesh.primitive_count());
    }

    TreeFacts run() {
        if (bvh_.nodes.empty()) {
            EXPECT_TRUE(bvh_.triangle_blocks.empty() && bvh_.sphere_blocks.empty());
            return facts_;
        }
        const ExactBounds scene = {glm::dvec3(bvh_.bounds.lower), glm::dvec3(bvh_.bounds.upper)};
        const ExactBounds found = visit_node(0, 1);
        EXPECT_TRUE(found.lower == scene.lower && found.upper == scene.upper);
        cost_ += found.area();
        facts_.surface_area_cost = found.area() > 0 ? cost_ / found.area() : 0;
        for (const auto* uses : {&node_uses_, &triangle_block_uses_, &sphere_block_uses_})
            EXPECT_EQ(std::count(uses->begin(), uses->end(), 1), static_cast<std::ptrdiff_t>(uses->size()));
        EXPECT_EQ(facts_.depth, bvh_.statistics.depth);
        EXPECT_LE(facts_.depth, BVH_MAX_DEPTH);
        // The same sum of at most some million doubles in another order.
        EXPECT_NEAR(facts_.surface_area_cost, bvh_.statistics.surface_area_cost, 1e-9 * facts_.surface_area_cost);
        return facts_;
    }

  private:
    /// Returns the union of the node's child boxes, which a parent's slot must enclose.
    ExactBounds visit_node(std::uint32_t index, int depth) {
        ExactBounds all;
        if (index >= bvh_.nodes.size() || ++node_uses_[index] > 1 || depth > 1000) {
            ADD_FAILURE() << "node " << index << " is missing or used twice";
            return all;
        }
        facts_.depth = std::max(facts_.depth, depth);
        const BvhNode& node = bvh_.nodes[index];
        std::uint32_t next_inner = 0;
        for (int slot = 0; slot < BVH_WIDTH; ++slot) {
            EXPECT_EQ(node.unused[slot], 0u);
            const ExactBounds box = slot_box(node, slot);
            const std::uint32_t child = node.child[slot];
            if (child == 0) {
                EXPECT_TRUE(box.lower == glm::dvec3(INFINITY) && box.upper == glm::dvec3(-INFINITY));
                continue;
            }
            all.add(box.lower, box.upper);
            if (child & CHILD_LEAF) {
                EXPECT_TRUE(box.encloses(visit_leaf(child, box.area())));
                continue;
            }
            cost_ += box.area();
            EXPECT_TRUE(next_inner == 0 || child == next_inner) << "siblings are not adjacent";
            next_inner = child + 1;
            EXPECT_TRUE(box.encloses(visit_node(child, depth + 1)));
        }
        return all;
    }

    ExactBounds visit_leaf(std::uint32_t child, double area) {
        const std::uint32_t first = child & CHILD_FIRST_MASK;
        const std::uint32_t blocks = (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK) + 1;
        const bool spheres = (child & CHILD_SPHERES) != 0;
        cost_ += area * blocks;
        auto& uses = spheres ? sphere_block_uses_ : triangle_block_uses_;
        ExactBounds bounds;
        if (first + blocks > uses.size()) {
            ADD_FAILURE() << "leaf beyond the blocks";
            return bounds;
        }
        for (std::uint32_t block = first; block < first + blocks; ++block) {
            ++uses[block];
            for (int lane = 0; lane < BVH_WIDTH; ++lane) {
                const std::uint32_t id =
                    spheres ? bvh_.sphere_blocks[block].primitive[lane] : bvh_.triangle_blocks[block].primitive[lane];
                const bool may_be_unused = block == first + blocks - 1 && lane > 0;
                EXPECT_TRUE(id != NO_INDEX || may_be_unused) << "unused lanes are the last ones of a leaf";
                spheres ? visit_sphere(bvh_.sphere_blocks[block], lane, bounds)
                        : visit_triangle(bvh_.triangle_blocks[block], lane, bounds);
            }
        }
        return bounds;
    }

    void visit_triangle(const TriangleBlock& block, int lane, ExactBounds& bounds) {
        const std::uint32_t id = block.primitive[lane];
        glm::vec3 corner[3];
        for (int i = 0; i < 3; ++i)
            for (int axis = 0; axis < 3; ++axis) corner[i][axis] = block.position[i][axis][lane];
        if (id == NO_INDEX) {
            EXPECT_TRUE(corner[0] == corner[1] && corner[0] == corner[2]);
            return;
        }
        ASSERT_LT(id, mesh_.triangles.size());
        ++facts_.occurrences[id];
        for (int i = 0; i < 3; ++i) {
            const Vertex& vertex = mesh_.vertices[mesh_.triangles[id].vertex[i]];
            EXPECT_EQ(corner[i], glm::vec3(vertex.position[0], vertex.position[1], vertex.position[2]));
            bounds.add(corner[i], corner[i]);
        }
    }

    void visit_sphere(const SphereBlock& block, int lane, ExactBounds& bounds) {
        const std::uint32_t id = block.primitive[lane];
        if (id == NO_INDEX) {
            EXPECT_EQ(block.radius[lane], 0.0f);
            return;
        }
        ASSERT_TRUE(id >= mesh_.triangles.size() && id < mesh_.primitive_count());
        ++facts_.occurrences[id];
        const Sphere& sphere = mesh_.spheres[id - mesh_.triangles.size()];
        const glm::dvec3 center(block.center[0][lane], block.center[1][lane], block.center[2][lane]);
        EXPECT_EQ(center, glm::dvec3(sphere.center[0], sphere.center[1], sphere.center[2]));
        EXPECT_EQ(block.radius[lane], sphere.radius);
        bounds.add(center - static_cast<double>(sphere.radius), center + static_cast<double>(sphere.radius));
    }

    static ExactBounds slot_box(const BvhNode& node, int slot) {
        ExactBounds box;
        for (int axis = 0; axis < 3; ++axis) {
            box.lower[axis] = node.bounds[0][axis][slot];
            box.upper[axis] = node.bounds[1][axis][slot];
        }
        return box;
    }

    const Mesh& mesh_;
    const Bvh& bvh_;
    std::vector<int> node_uses_, triangle_block_uses_, sphere_block_uses_;
    TreeFacts facts_;
    double cost_ = 0;
};

}  // namespace

TreeFacts check_tree(const Mesh& mesh, const Bvh& bvh) {
    return Walk(mesh, bvh).run();
}

void expect_complete_tree(const Mesh& mesh, const Bvh& bvh) {
    const TreeFacts facts = check_tree(mesh, bvh);
    for (std::size_t id = 0; id < facts.occurrences.size(); ++id) ASSERT_EQ(facts.occurrences[id], 1) << "id " << id;
}

void expect_complete_trees(const Mesh& mesh) {
    for (const BvhQuality quality : QUALITIES) expect_complete_tree(mesh, mesh.build(0, quality));
}

}  // namespace raymill::test
