// Vertex normals from faces: corners that meet across smooth edges are joined, and each joint gets one normal,
// the mean of its faces' normals weighted by their angles (Thuermer and Wuethrich, "Computing Vertex Normals from
// Polygonal Facets", JGT 1998).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string_view>
#include <unordered_map>

#include "scene/mesh.hpp"

namespace raymill {
namespace {

/// Disjoint sets with path halving (Tarjan and van Leeuwen 1984); the smaller index is the root.
class Joints {
  public:
    explicit Joints(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t root(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::uint32_t> parent_;
};

struct Edge {
    std::uint64_t ends;    // the two positions, lower first
    std::uint32_t corner;  // 3 * triangle + corner where the edge starts
};

using PositionIds = std::vector<std::uint32_t>;

std::vector<Edge> sorted_edges(const IndexedMesh& mesh, const PositionIds& ids) {
    std::vector<Edge> edges;
    edges.reserve(mesh.triangles.size() * 3);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::uint32_t c = 0; c < 3; ++c) {
            const std::uint64_t a = ids[mesh.triangles[t][c].position];
            const std::uint64_t b = ids[mesh.triangles[t][(c + 1) % 3].position];
            edges.push_back({std::min(a, b) << 32 | std::max(a, b), 3 * t + c});
        }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.ends != b.ends ? a.ends < b.ends : a.corner < b.corner; });
    return edges;
}

/// Joins the corners of two triangles that sit at the same positions.
void join_triangles(const IndexedMesh& mesh, const PositionIds& ids, std::uint32_t s, std::uint32_t t, Joints& joints) {
    for (std::uint32_t i = 0; i < 3; ++i)
        for (std::uint32_t j = 0; j < 3; ++j)
            if (ids[mesh.triangles[s][i].position] == ids[mesh.triangles[t][j].position])
                joints.join(3 * s + i, 3 * t + j);
}

std::vector<glm::dvec3> face_normals(const IndexedMesh& mesh) {
    std::vector<glm::dvec3> normals;
    normals.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        const glm::dvec3& p = mesh.positions[a.position];
        const glm::dvec3 n = glm::cross(mesh.positions[b.position] - p, mesh.positions[c.position] - p);
        const double length = glm::length(n);
        normals.push_back(length > 0 && std::isfinite(length) ? n / length : glm::dvec3(0));
    }
    return normals;
}

double angle_at(const IndexedMesh& mesh, const std::array<Corner, 3>& triangle, int c) {
    const glm::dvec3& p = mesh.positions[triangle[c].position];
    const glm::dvec3 a = mesh.positions[triangle[(c + 1) % 3].position] - p;
    const glm::dvec3 b = mesh.positions[triangle[(c + 2) % 3].position] - p;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Gives the corners that `wants(triangle, corner)` one normal for each joint.
template <class Wants>
void average(IndexedMesh& mesh, const std::vector<glm::dvec3>& normals, Joints& joints, Wants wants) {
    std::vector<std::uint32_t> normal_of_root(mesh.triangles.size() * 3, NO_INDEX);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::uint32_t c = 0; c < 3; ++c) {
            Corner& corner = mesh.triangles[t][c];
            if (!wants(t, corner)) continue;
            std::uint32_t& index = normal_of_root[joints.root(3 * t + c)];
            if (index == NO_INDEX) {
                index = static_cast<std::uint32_t>(mesh.normals.size());
                mesh.normals.emplace_back(0);
            }
            corner.normal = index;
            if (normals[t] != glm::dvec3(0))
                mesh.normals[index] += angle_at(mesh, mesh.triangles[t], static_cast<int>(c)) * normals[t];
        }
}

/// Joins corners across each edge whose two triangles `smooth(s, t)` says so; all pairs in a row where more than two
/// meet.
template <class Smooth>
Joints join_across_edges(const IndexedMesh& mesh, const PositionIds& ids, Smooth smooth) {
    Joints joints(mesh.triangles.size() * 3);
    const std::vector<Edge> edges = sorted_edges(mesh, ids);
    for (std::size_t i = 1; i < edges.size(); ++i) {
        const std::uint32_t s = edges[i - 1].corner / 3, t = edges[i].corner / 3;
        if (edges[i - 1].ends == edges[i].ends && s != t && smooth(s, t)) join_triangles(mesh, ids, s, t, joints);
    }
    return joints;
}

struct PositionHash {
    std::size_t operator()(const glm::dvec3& p) const {
        return std::hash<std::string_view>()({reinterpret_cast<const char*>(&p), sizeof p});
    }
};

/// One id for each distinct position.
PositionIds welded(const std::vector<glm::dvec3>& positions) {
    std::unordered_map<glm::dvec3, std::uint32_t, PositionHash> seen(positions.size());
    PositionIds ids;
    ids.reserve(positions.size());
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const glm::dvec3 p = positions[i] + 0.0;                           // -0 becomes 0
        ids.push_back(p == p ? seen.try_emplace(p, i).first->second : i);  // NaN is equal to nothing
    }
    return ids;
}

}  // namespace

void smooth_by_angle(IndexedMesh& mesh, double degrees) {
    const std::vector<glm::dvec3> normals = face_normals(mesh);
    const double cos_limit = std::cos(glm::radians(degrees));
    Joints joints = join_across_edges(mesh, welded(mesh.positions), [&](std::uint32_t s, std::uint32_t t) {
        return glm::dot(normals[s], normals[t]) > cos_limit;
    });
    mesh.normals.clear();
    average(mesh, normals, joints, [](std::uint32_t, const Corner&) { return true; });
}

void smooth_by_groups(IndexedMesh& mesh) {
    const auto& groups = mesh.smoothing_groups;
    if (std::all_of(groups.begin(), groups.end(), [](std::uint32_t group) { return group == 0; })) return;
    PositionIds ids(mesh.positions.size());
    std::iota(ids.begin(), ids.end(), 0u);
    Joints joints = join_across_edges(
        mesh, ids, [&](std::uint32_t s, std::uint32_t t) { return groups[s] != 0 && groups[s] == groups[t]; });
    average(mesh, face_normals(mesh), joints,
            [&](std::uint32_t t, const Corner& corner) { return groups[t] != 0 && corner.normal == NO_INDEX; });
}

}  // namespace raymill
