// A tree is worth its build time.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "meshes.hpp"
#include "tree_check.hpp"

namespace raymill::test {
namespace {

struct Extent {
    glm::vec3 lower{INFINITY}, upper{-INFINITY};

    void add(const Extent& other) {
        lower = glm::min(lower, other.lower);
        upper = glm::max(upper, other.upper);
    }
    double area() const {
        const glm::dvec3 e = glm::dvec3(upper) - glm::dvec3(lower);
        return e.x * e.y + e.y * e.z + e.z * e.x;
    }
};

/// The SAH cost of an eight-wide tree that halves at the median centroid of the longest axis, leaves of one block:
/// what a builder without any heuristic gives. Counts node and leaf visits as BvhStatistics does.
class MedianTree {
  public:
    explicit MedianTree(const Mesh& mesh) {
        for (const Triangle& triangle : mesh.triangles) {
            Extent extent;
            for (const std::uint32_t index : triangle.vertex) {
                const float* p = mesh.vertices[index].position;
                extent.add({{p[0], p[1], p[2]}, {p[0], p[1], p[2]}});
            }
            extents_.push_back(extent);
        }
        order_.resize(extents_.size());
        std::iota(order_.begin(), order_.end(), std::size_t{0});
    }

    double cost() { return cost(0, order_.size(), 0) / whole(0, order_.size()).area(); }

  private:
    Extent whole(std::size_t begin, std::size_t end) const {
        Extent extent;
        for (std::size_t i = begin; i < end; ++i) extent.add(extents_[order_[i]]);
        return extent;
    }

    /// Every third level becomes a wide node.
    double cost(std::size_t begin, std::size_t end, int level) {
        const Extent extent = whole(begin, end);
        if (end - begin <= BVH_WIDTH) return extent.area();
        const glm::vec3 size = extent.upper - extent.lower;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = (begin + end) / 2;
        const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
            return extents_[a].lower[axis] + extents_[a].upper[axis] <
                   extents_[b].lower[axis] + extents_[b].upper[axis];
        });
        return (level % 3 == 0 ? extent.area() : 0) + cost(begin, middle, level + 1) + cost(middle, end, level + 1);
    }

    std::vector<Extent> extents_;
    std::vector<std::size_t> order_;
};

/// `share`: of the median tree's cost, at most.
void expect_cheaper_than_median(const Mesh& mesh, double share) {
    const double median = MedianTree(mesh).cost();
    for (const BvhQuality quality : QUALITIES) {
        const double found = check_tree(mesh, mesh.build(0, quality)).surface_area_cost;
        fmt::print("cost {:.2f}, median split {:.2f}\n", found, median);
        EXPECT_LT(found, share * median);
    }
}

TEST(BvhQuality, sah_beats_median_splits_on_an_uneven_sheet) {
    // Found 0.55 here, 0.68 and 0.28 below; a builder that lost the heuristic would come near 1.
    expect_cheaper_than_median(uneven_sheet(150), 0.65);
}

TEST(BvhQuality, sah_beats_median_splits_on_triangles_of_many_sizes) {
    Mesh mesh = random_soup(20000, 1, 0.003f);
    const Mesh large = random_soup(500, 2, 0.3f);
    for (const Triangle& t : large.triangles) {
        glm::vec3 p[3];
        for (int i = 0; i < 3; ++i) {
            const float* q = large.vertices[t.vertex[i]].position;
            p[i] = {q[0], q[1], q[2]};
        }
        mesh.add_triangle(p[0], p[1], p[2]);
    }
    expect_cheaper_than_median(mesh, 0.8);
}

/// Cost of the tree of high quality relative to that of the fast one.
double cost_of_high(const Mesh& mesh) {
    const double fast = mesh.build(0, BvhQuality::fast).statistics.surface_area_cost;
    const double high = mesh.build(0, BvhQuality::high).statistics.surface_area_cost;
    fmt::print("cost fast {:.3f}, high {:.3f}\n", fast, high);
    return high / fast;
}

TEST(BvhQuality, reinsertion_helps_where_objects_lie_among_each_other) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < 60; ++i) {
        const Mesh object = random_soup(300, i, 0.02f);
        const Mesh place = random_soup(1, 100 + i, 1);
        const float* at = place.vertices[0].position;
        for (const Triangle& t : object.triangles) {
            glm::vec3 p[3];
            for (int corner = 0; corner < 3; ++corner) {
                const float* q = object.vertices[t.vertex[corner]].position;
                p[corner] = glm::vec3(at[0], at[1], at[2]) + 0.3f * glm::vec3(q[0], q[1], q[2]);
            }
            mesh.add_triangle(p[0], p[1], p[2]);
        }
    }
    EXPECT_LT(cost_of_high(mesh), 0.98);
}

TEST(BvhQuality, reinsertion_does_not_spoil_an_even_sheet) {
    EXPECT_LT(cost_of_high(uneven_sheet(150)), 1.001);
}

TEST(BvhQuality, sah_beats_median_splits_on_a_modelled_cat) {
    const auto mesh = read_obj(RAYMILL_TEST_DATA "/obj/egyptcat/egyptcat.obj");
    if (!mesh) GTEST_SKIP() << "no " RAYMILL_TEST_DATA "/obj/egyptcat/egyptcat.obj";
    ASSERT_GT(mesh->triangles.size(), 10000u);
    expect_cheaper_than_median(*mesh, 0.4);
}

TEST(BvhQuality, a_million_triangles_are_complete) {
    const Mesh mesh = uneven_sheet(708);
    for (const BvhQuality quality : QUALITIES) {
        const Bvh bvh = mesh.build(0, quality);
        fmt::print(
            "{} triangles in {:.3f} s: {:.2f} million a second; cost {:.2f}, depth {}, {:.2f} triangles a block\n",
            mesh.triangles.size(), bvh.statistics.seconds,
            static_cast<double>(mesh.triangles.size()) / bvh.statistics.seconds * 1e-6,
            bvh.statistics.surface_area_cost, bvh.statistics.depth,
            static_cast<double>(mesh.triangles.size()) / static_cast<double>(bvh.triangle_blocks.size()));
        expect_complete_tree(mesh, bvh);
    }
}

}  // namespace
}  // namespace raymill::test
