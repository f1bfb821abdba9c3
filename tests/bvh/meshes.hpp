// Geometry to build trees over: random and regular, pleasant and degenerate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bvh/bvh.hpp"

namespace raymill::test {

struct Mesh {
    std::vector<Vertex> vertices;
    std::vector<Triangle> triangles;
    std::vector<Sphere> spheres;

    void add_triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
    void add_sphere(const glm::vec3& center, float radius);
    std::size_t primitive_count() const { return triangles.size() + spheres.size(); }
    Bvh build(unsigned threads = 0, BvhQuality quality = BvhQuality::high) const {
        return build_bvh(vertices, triangles, spheres, {threads, quality});
    }
};

inline constexpr BvhQuality QUALITIES[] = {BvhQuality::fast, BvhQuality::high};

/// Triangles with corners within `size` of centres in the unit cube.
Mesh random_soup(std::size_t count, std::uint32_t seed, float size = 0.1f);

/// Long thin triangles across the unit cube, width 1e-6.
Mesh slivers(std::size_t count, std::uint32_t seed);

/// A wavy sheet over the unit square of 2 * side^2 triangles, finer towards one corner: edges differ 100-fold.
Mesh uneven_sheet(std::uint32_t side);

/// Spheres of radius up to 0.05 in the unit cube.
Mesh random_spheres(std::size_t count, std::uint32_t seed);

/// Triangles about the origin of sizes that differ: all bounds are concentric.
Mesh concentric_triangles(std::size_t count);

/// The same triangle again and again.
Mesh identical_triangles(std::size_t count);

/// Tiny triangles at all powers of two that floats hold, on the three axes: no grid of bins separates many at a time.
Mesh octaves();

/// Triangles (fans of polygons) of a Wavefront file, nothing else of it; none where the file is absent.
std::optional<Mesh> read_obj(const std::string& file);

}  // namespace raymill::test
