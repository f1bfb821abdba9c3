#include "scene/mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace raymill {
namespace {

std::uint64_t mixed(std::uint64_t x) {  // splitmix64's finaliser (Steele, Lea, Flood, 2014)
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// Finds the index at which each distinct corner was first added: open addressing over the next power of two.
class CornerIndex {
  public:
    explicit CornerIndex(std::size_t corners) : slots_(std::bit_ceil(corners + corners / 2 + 1), NO_INDEX) {}

    /// The corner's index, and whether it is new.
    std::pair<std::uint32_t, bool> insert(const Corner& corner) {
        const std::size_t mask = slots_.size() - 1;
        const std::uint64_t key = (std::uint64_t{corner.position} << 32 | corner.normal) + mixed(corner.uv);
        for (std::size_t slot = mixed(key) & mask;; slot = (slot + 1) & mask) {
            if (slots_[slot] == NO_INDEX) {
                slots_[slot] = static_cast<std::uint32_t>(corners_.size());
                corners_.push_back(corner);
                return {slots_[slot], true};
            }
            if (corners_[slots_[slot]] == corner) return {slots_[slot], false};
        }
    }

  private:
    std::vector<std::uint32_t> slots_;
    std::vector<Corner> corners_;
};

Vertex world_vertex(const IndexedMesh& mesh, const Corner& corner, const Transform& transform) {
    const glm::vec3 position(transform.point(mesh.positions[corner.position]));
    const glm::vec3 normal(corner.normal == NO_INDEX ? glm::dvec3(0) : transform.normal(mesh.normals[corner.normal]));
    const glm::vec2 uv(corner.uv == NO_INDEX ? glm::dvec2(0) : mesh.uvs[corner.uv]);
    return {{position.x, position.y, position.z}, {normal.x, normal.y, normal.z}, {uv.x, uv.y}};
}

/// Makes room without giving up that a vector grows by factors, however many meshes come one by one.
template <typename T>
void reserve_more(std::vector<T>& values, std::size_t more) {
    const std::size_t needed = values.size() + more;
    if (needed > values.capacity()) values.reserve(std::max(needed, 2 * values.capacity()));
}

}  // namespace

void append_mesh(Scene& scene, const IndexedMesh& mesh, const Transform& transform, std::uint32_t material,
                 std::uint32_t object) {
    const auto first = static_cast<std::uint32_t>(scene.vertices.size());
    const bool mirrors = transform.mirrors();
    CornerIndex index(mesh.triangles.size() * 3);
    reserve_more(scene.triangles, mesh.triangles.size());
    reserve_more(scene.vertices, mesh.positions.size());  // at least
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Triangle triangle{};
        for (int c = 0; c < 3; ++c) {
            const Corner& corner = mesh.triangles[t][mirrors ? 2 - c : c];
            const auto [vertex, is_new] = index.insert(corner);
            if (is_new) scene.vertices.push_back(world_vertex(mesh, corner, transform));
            triangle.vertex[c] = first + vertex;
        }
        triangle.material = mesh.materials.empty() ? material : mesh.materials[t];
        triangle.object = mesh.objects.empty() ? object : mesh.objects[t];
        scene.triangles.push_back(triangle);
    }
}

}  // namespace raymill
