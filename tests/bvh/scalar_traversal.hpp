// The closest hit of a ray by two ways that share one arithmetic: through the tree, and through all primitives.
#pragma once

#include <vector>

#include "bvh/bvh.hpp"
#include "meshes.hpp"

namespace raymill::test {

struct TestRay {
    glm::dvec3 origin;
    glm::dvec3 direction;
};

/// Equal distances: the lowest id.
struct TestHit {
    double t = INFINITY;
    std::uint32_t primitive = NO_INDEX;

    bool operator==(const TestHit&) const = default;
};

TestHit hit_by_tree(const Bvh& bvh, const TestRay& ray);
TestHit hit_by_brute_force(const Mesh& mesh, const TestRay& ray);

/// Rays from around the bounds to points within them, some along axes, some from within.
std::vector<TestRay> rays_at(const Bounds& bounds, int count, std::uint32_t seed);

}  // namespace raymill::test
