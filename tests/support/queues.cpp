#include "queues.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace raymill::test {

namespace {

bool is_finite(const float (&v)[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

Vertex vertex_at(const glm::dvec3& p) {
    Vertex vertex{};
    store(vertex.position, glm::vec3(p));
    return vertex;
}

/// Triangle blocks in the order of the ids.
std::vector<TriangleBlock> triangle_blocks(const Scene& scene) {
    std::vector<TriangleBlock> blocks;
    int lane = BVH_WIDTH;
    for (std::size_t id = 0; id < scene.triangles.size(); ++id) {
        const uint* corners = scene.triangles[id].vertex;
        if (!std::all_of(corners, corners + 3, [&](uint v) { return is_finite(scene.vertices[v].position); })) continue;
        if (lane == BVH_WIDTH) {
            blocks.emplace_back();
            std::fill_n(blocks.back().primitive, BVH_WIDTH, NO_INDEX);
            lane = 0;
        }
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 3; ++axis)
                blocks.back().position[corner][axis][lane] = scene.vertices[corners[corner]].position[axis];
        blocks.back().primitive[lane++] = static_cast<uint>(id);
    }
    return blocks;
}

std::vector<SphereBlock> sphere_blocks(const Scene& scene) {
    std::vector<SphereBlock> blocks((scene.spheres.size() + BVH_WIDTH - 1) / BVH_WIDTH);
    for (std::size_t i = 0; i < blocks.size() * BVH_WIDTH; ++i) {
        SphereBlock& block = blocks[i / BVH_WIDTH];
        const std::size_t lane = i % BVH_WIDTH;
        const bool used = i < scene.spheres.size();
        for (int axis = 0; axis < 3; ++axis) block.center[axis][lane] = used ? scene.spheres[i].center[axis] : 0;
        block.radius[lane] = used ? scene.spheres[i].radius : 0;
        block.primitive[lane] = used ? static_cast<uint>(scene.triangles.size() + i) : NO_INDEX;
    }
    return blocks;
}

/// Leaves of up to eight blocks.
void add_leaves(std::size_t blocks, uint kind, std::vector<uint>& children) {
    for (std::size_t first = 0; first < blocks; first += 8) {
        const auto further = static_cast<uint>(std::min<std::size_t>(8, blocks - first)) - 1;
        children.push_back(CHILD_LEAF | kind | further << CHILD_BLOCKS_SHIFT | static_cast<uint>(first));
    }
}

}  // namespace

Mesh icosphere(int levels, float radius, const glm::vec3& center) {
    const double phi = (1 + std::sqrt(5.0)) / 2;
    std::vector<glm::dvec3> points = {{-1, phi, 0}, {1, phi, 0}, {-1, -phi, 0}, {1, -phi, 0},
                                      {0, -1, phi}, {0, 1, phi}, {0, -1, -phi}, {0, 1, -phi},
                                      {phi, 0, -1}, {phi, 0, 1}, {-phi, 0, -1}, {-phi, 0, 1}};
    std::vector<std::array<uint, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                              {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                              {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                              {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<uint, uint>, uint> middles;
        const auto middle = [&](uint a, uint b) {
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<uint>(points.size()));
            if (is_new) points.push_back(points[a] + points[b]);
            return place->second;
        };
        std::vector<std::array<uint, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const uint ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        for (glm::dvec3& p : points) p = glm::normalize(p);
        faces = finer;
    }
    Mesh mesh;
    for (const glm::dvec3& p : points)
        mesh.vertices.push_back(vertex_at(glm::dvec3(center) + static_cast<double>(radius) * glm::normalize(p)));
    for (const auto& [a, b, c] : faces) mesh.triangles.push_back({{a, b, c}, 0, 0});
    return mesh;
}

Mesh box(const glm::vec3& lower, const glm::vec3& upper) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(
            vertex_at({i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z}));
    const uint quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& [a, b, c, d] : quads) {
        mesh.triangles.push_back({{a, b, c}, 0, 0});
        mesh.triangles.push_back({{a, c, d}, 0, 0});
    }
    return mesh;
}

Bvh uncullable_bvh(const Scene& scene) {
    Bvh bvh;
    const std::vector<TriangleBlock> triangles = triangle_blocks(scene);
    const std::vector<SphereBlock> spheres = sphere_blocks(scene);
    bvh.triangle_blocks.assign(triangles.begin(), triangles.end());
    bvh.sphere_blocks.assign(spheres.begin(), spheres.end());
    std::vector<uint> level;
    add_leaves(bvh.triangle_blocks.size(), 0, level);
    add_leaves(bvh.sphere_blocks.size(), CHILD_SPHERES, level);
    if (level.empty()) return bvh;
    // Eight children a node, bottom up; the root must come first, so nodes are numbered from the end and turned around.
    std::vector<BvhNode> nodes;
    do {
        std::vector<uint> parents;
        for (std::size_t first = 0; first < level.size(); first += BVH_WIDTH) {
            BvhNode node{};
            for (int lane = 0; lane < BVH_WIDTH; ++lane) {
                const bool used = first + static_cast<std::size_t>(lane) < level.size();
                node.child[lane] = used ? level[first + static_cast<std::size_t>(lane)] : 0;
                for (int axis = 0; axis < 3; ++axis) {
                    node.bounds[0][axis][lane] = used ? -INFINITY : INFINITY;
                    node.bounds[1][axis][lane] = used ? INFINITY : -INFINITY;
                }
            }
            parents.push_back(static_cast<uint>(nodes.size()));
            nodes.push_back(node);
        }
        level = parents;
    } while (level.size() > 1);
    const auto last = static_cast<uint>(nodes.size()) - 1;
    for (BvhNode& node : nodes)
        for (int lane = 0; lane < BVH_WIDTH; ++lane)
            if (node.bounds[0][0][lane] < 0 && !(node.child[lane] & CHILD_LEAF))
                node.child[lane] = last - node.child[lane];
    std::reverse(nodes.begin(), nodes.end());
    bvh.nodes.assign(nodes.begin(), nodes.end());
    return bvh;
}

}  // namespace raymill::test
