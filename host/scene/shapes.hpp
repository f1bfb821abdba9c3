// The scene file's shapes as triangles. All are counter-clockwise seen from outside; cylinder, cone, box, ellipsoid and
// a lathe whose profile ends on the axis are closed: each edge is shared by two triangles with the very same points.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "scene/mesh.hpp"

namespace raymill {

/// Sides of a full circle: chord error 1 - cos(pi / 72) = 9.5e-4 of the radius.
constexpr std::uint32_t circle_segments = 72;

/// Faces normal. radius > 0; the normal of any length but zero.
IndexedMesh disk_mesh(const glm::dvec3& center, const glm::dvec3& normal, double radius);
/// Two triangles that face edge_u x edge_v; the edges are full edges through the centre.
IndexedMesh rectangle_mesh(const glm::dvec3& center, const glm::dvec3& edge_u, const glm::dvec3& edge_v);
/// Twelve flat triangles; lower < upper on each axis.
IndexedMesh box_mesh(const glm::dvec3& lower, const glm::dvec3& upper);
/// With both caps flat and a smooth side.
IndexedMesh cylinder_mesh(const glm::dvec3& base, const glm::dvec3& top, double radius);
/// Its disk at base, its tip at top.
IndexedMesh cone_mesh(const glm::dvec3& base, const glm::dvec3& top, double radius);
/// A sphere by longitude and latitude (poles on y), for transforms that make it an ellipsoid; smooth.
IndexedMesh sphere_mesh(const glm::dvec3& center, double radius);

struct LatheShape {
    std::span<const glm::dvec2> profile;  // (r, y) with r >= 0, at least two points, neighbours differ
    glm::dvec3 center{0};
    std::uint32_t segments = 64;
    double smooth_angle = 40;  // degrees
};
/// The profile revolved about the y axis through `center`. Outside lies to the right of the way along the profile, with
/// r to the right and y up: a profile that goes up has its outside away from the axis. Points with r = 0 become one
/// vertex; a profile that ends where it began becomes a ring.
IndexedMesh lathe_mesh(const LatheShape& shape);

}  // namespace raymill
