// Triangle meshes on their way into the scene: separate indices for positions, normals and uvs, as OBJ has them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/scene.hpp"
#include "scene/transform.hpp"

namespace raymill {

/// A corner of a face; NO_INDEX where it has no normal (a flat face) or no uv (read as 0, 0).
struct Corner {
    std::uint32_t position = NO_INDEX;
    std::uint32_t normal = NO_INDEX;
    std::uint32_t uv = NO_INDEX;
    bool operator==(const Corner&) const = default;
};

/// Triangles in an object's own space, counter-clockwise seen from outside.
struct IndexedMesh {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;  // any length; zero means flat
    std::vector<glm::dvec2> uvs;
    std::vector<std::array<Corner, 3>> triangles;
    std::vector<std::uint32_t> smoothing_groups;  // one a triangle, 0 is none; or empty
    std::vector<std::uint32_t> materials;         // one a triangle, or empty: one for all
    std::vector<std::uint32_t> objects;           // one a triangle, or empty: one for all
    double chord_error = 0;                       // largest distance from the exact surface
};

/// Splits a simple polygon into its size - 2 triangles (indices into `corners`), winding kept: a quad along a diagonal
/// inside it (the shorter if both are), others by ear clipping in the plane of the polygon's Newell normal
/// (Meisters, "Polygons have ears", 1975). Polygons that cross themselves give triangles all the same.
void triangulate(std::span<const glm::dvec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Replaces all normals: those of faces that meet at an edge under less than `degrees` are averaged at the edge's ends,
/// weighted by the faces' angles there. Equal positions count as one vertex.
void smooth_by_angle(IndexedMesh& mesh, double degrees);

/// Gives corners without a normal the average within their smoothing group (not 0) around the vertex, angle-weighted.
void smooth_by_groups(IndexedMesh& mesh);

/// Appends the mesh to the scene in world space: one Vertex for each distinct corner, winding flipped if the
/// transform mirrors. `material` and `object` serve where the mesh has none of its own.
void append_mesh(Scene& scene, const IndexedMesh& mesh, const Transform& transform, std::uint32_t material,
                 std::uint32_t object);

}  // namespace raymill
