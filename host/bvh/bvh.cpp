#include "bvh/bvh.hpp"

#include <tbb/task_arena.h>

#include <chrono>
#include <utility>

#include "bvh/binary_tree.hpp"
#include "bvh/primitive_refs.hpp"
#include "bvh/reinsertion.hpp"
#include "bvh/wide_tree.hpp"

namespace raymill {

Bvh build_bvh(std::span<const Vertex> vertices, std::span<const Triangle> triangles, std::span<const Sphere> spheres,
              const BvhOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    Bvh result;
    tbb::task_arena arena(options.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(options.threads));
    arena.execute([&] {
        bvh::PrimitiveRefs refs = bvh::make_primitive_refs(vertices, triangles, spheres);
        result.statistics.dropped_not_finite = refs.dropped_not_finite;
        result.statistics.dropped_zero_area = refs.dropped_zero_area;
        if (refs.refs.empty()) return;
        const auto triangle_count = static_cast<std::uint32_t>(triangles.size());
        bvh::BinaryTree tree = bvh::build_binary_tree(std::move(refs), triangle_count);
        if (options.quality == BvhQuality::high) tree = bvh::reinsert(std::move(tree), triangle_count);
        bvh::collapse_to_wide(tree, vertices, triangles, spheres, result);
    });
    result.statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

}  // namespace raymill
