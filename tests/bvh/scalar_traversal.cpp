#include "scalar_traversal.hpp"

#include <algorithm>
#include <random>

namespace raymill::test {
namespace {

void keep_closer(double t, std::uint32_t primitive, TestHit& best) {
    if (t > 0 && (t < best.t || (t == best.t && primitive < best.primitive))) best = {t, primitive};
}

/// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (1997).
void intersect_triangle(const TestRay& ray, const glm::dvec3 (&p)[3], std::uint32_t primitive, TestHit& best) {
    const glm::dvec3 edge1 = p[1] - p[0], edge2 = p[2] - p[0];
    const glm::dvec3 normal_like = glm::cross(ray.direction, edge2);
    const double determinant = glm::dot(edge1, normal_like);
    if (determinant == 0) return;
    const glm::dvec3 from_corner = ray.origin - p[0];
    const double u = glm::dot(from_corner, normal_like) / determinant;
    const glm::dvec3 other = glm::cross(from_corner, edge1);
    const double v = glm::dot(ray.direction, other) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1) keep_closer(glm::dot(edge2, other) / determinant, primitive, best);
}

void intersect_sphere(const TestRay& ray, const glm::dvec3& center, double radius, std::uint32_t primitive,
                      TestHit& best) {
    const glm::dvec3 from_center = ray.origin - center;
    const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(from_center, ray.direction);
    const double discriminant = b * b - a * (glm::dot(from_center, from_center) - radius * radius);
    if (discriminant < 0) return;
    keep_closer((-b - std::sqrt(discriminant)) / a, primitive, best);
    keep_closer((-b + std::sqrt(discriminant)) / a, primitive, best);
}

/// Widened well beyond the rounding of both tests (2^-53 each operation), so that it never culls what they would hit.
bool may_hit_box(const TestRay& ray, const BvhNode& node, int slot, double t_max) {
    constexpr double MARGIN = 1e-6;
    double near = 0, far = t_max;
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = node.bounds[0][axis][slot], upper = node.bounds[1][axis][slot];
        const double slack = MARGIN * (upper - lower + std::abs(ray.origin[axis]));
        const double a = lower - slack - ray.origin[axis], b = upper + slack - ray.origin[axis];
        if (ray.direction[axis] == 0) {
            if (a > 0 || b < 0) return false;
            continue;
        }
        const double ta = a / ray.direction[axis], tb = b / ray.direction[axis];
        near = std::max(near, std::min(ta, tb));
        far = std::min(far, std::max(ta, tb));
    }
    return near <= far * (1 + MARGIN);
}

void intersect_block(const TestRay& ray, const TriangleBlock& block, TestHit& best) {
    for (int lane = 0; lane < BVH_WIDTH; ++lane) {
        if (block.primitive[lane] == NO_INDEX) continue;
        glm::dvec3 p[3];
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 3; ++axis) p[corner][axis] = block.position[corner][axis][lane];
        intersect_triangle(ray, p, block.primitive[lane], best);
    }
}

void intersect_block(const TestRay& ray, const SphereBlock& block, TestHit& best) {
    for (int lane = 0; lane < BVH_WIDTH; ++lane)
        if (block.primitive[lane] != NO_INDEX)
            intersect_sphere(ray, {block.center[0][lane], block.center[1][lane], block.center[2][lane]},
                             block.radius[lane], block.primitive[lane], best);
}

void intersect_leaf(const Bvh& bvh, const TestRay& ray, std::uint32_t child, TestHit& best) {
    const std::uint32_t first = child & CHILD_FIRST_MASK;
    const std::uint32_t last = first + (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK);
    for (std::uint32_t block = first; block <= last; ++block)
        child& CHILD_SPHERES ? intersect_block(ray, bvh.sphere_blocks[block], best)
                             : intersect_block(ray, bvh.triangle_blocks[block], best);
}

}  // namespace

TestHit hit_by_tree(const Bvh& bvh, const TestRay& ray) {
    TestHit best;
    std::uint32_t stack[BVH_STACK_SIZE];
    int size = 0;
    if (!bvh.nodes.empty()) stack[size++] = 0;
    while (size > 0) {
        const BvhNode& node = bvh.nodes[stack[--size]];
        for (int slot = 0; slot < BVH_WIDTH; ++slot) {
            const std::uint32_t child = node.child[slot];
            if (child == 0 || !may_hit_box(ray, node, slot, best.t)) continue;
            if (child & CHILD_LEAF)
                intersect_leaf(bvh, ray, child, best);
            else
                stack[size++] = child;
        }
    }
    return best;
}

TestHit hit_by_brute_force(const Mesh& mesh, const TestRay& ray) {
    TestHit best;
    std::uint32_t id = 0;
    for (const Triangle& triangle : mesh.triangles) {
        glm::dvec3 p[3];
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 3; ++axis)
                p[corner][axis] = mesh.vertices[triangle.vertex[corner]].position[axis];
        intersect_triangle(ray, p, id++, best);
    }
    for (const Sphere& sphere : mesh.spheres)
        intersect_sphere(ray, {sphere.center[0], sphere.center[1], sphere.center[2]}, sphere.radius, id++, best);
    return best;
}

std::vector<TestRay> rays_at(const Bounds& bounds, int count, std::uint32_t seed) {
    std::mt19937 engine(seed);
    const auto unit = [&] { return static_cast<double>(engine()) / 4294967296.0; };
    const auto point = [&](double widening) {
        const double x = unit(), y = unit(), z = unit();
        const glm::dvec3 lower(bounds.lower), size = glm::dvec3(bounds.upper) - lower;
        return lower + size * ((glm::dvec3(x, y, z) - 0.5) * widening + 0.5);
    };
    std::vector<TestRay> rays;
    for (int i = 0; i < count; ++i) {
        TestRay ray = {point(i % 3 == 0 ? 1 : 4), {}};
        const glm::dvec3 target = point(1);
        if (i % 5 == 0) {  // along an axis, through the target
            const int axis = i % 3;
            const double start = ray.origin[axis];
            ray.origin = target;
            ray.origin[axis] = start;
        }
        ray.direction = target - ray.origin;
        if (ray.direction != glm::dvec3(0)) rays.push_back(ray);
    }
    return rays;
}

}  // namespace raymill::test
