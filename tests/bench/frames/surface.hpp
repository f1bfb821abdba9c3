// From a hit to the surface there, and where a ray that leaves it starts.
#pragma once

#include <algorithm>

#include "frames/world.hpp"

namespace raymill::bench {

struct SurfacePoint {
    vec3 position;
    float offset = 0;  // a ray that starts this far along the normal does not meet the surface again
    vec3 geometric;    // unit normals on the side that the ray came from
    vec3 shading;
    vec2 uv{0};
    vec3 weights{1, 0, 0};
    const Triangle* triangle = nullptr;  // none: a sphere or a plane
    const Material* material = nullptr;
    bool smooth = false;  // the shading normal is interpolated
    bool inside = false;  // the ray came from behind the outward normal
};

inline float largest(const vec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

inline constexpr float ROUNDING = 0x1p-24f;

inline bool has_normals(const Scene& scene, const Triangle& triangle) {
    return std::ranges::all_of(triangle.vertex, [&](uint v) { return vec(scene.vertices[v].normal) != vec3(0); });
}

inline void place_on_triangle(const World& world, const PathHit& hit, SurfacePoint& s) {
    const Triangle& triangle = world.scene.triangles[hit.primitive];
    const Vertex& a = world.scene.vertices[triangle.vertex[0]];
    const Vertex& b = world.scene.vertices[triangle.vertex[1]];
    const Vertex& c = world.scene.vertices[triangle.vertex[2]];
    const vec3 pa = vec(a.position), pb = vec(b.position), pc = vec(c.position);
    const vec3 w(1 - hit.u - hit.v, hit.u, hit.v);
    s.triangle = &triangle;
    s.weights = w;
    s.position = w.x * pa + w.y * pb + w.z * pc;
    s.geometric = s.shading = glm::normalize(glm::cross(pb - pa, pc - pa));
    s.offset = 16 * ROUNDING * std::max({largest(pa), largest(pb), largest(pc)});
    s.uv = w.x * vec2(a.uv[0], a.uv[1]) + w.y * vec2(b.uv[0], b.uv[1]) + w.z * vec2(c.uv[0], c.uv[1]);
    if ((s.material->flags & MATERIAL_FLAT) || !has_normals(world.scene, triangle)) return;
    const vec3 normal = w.x * vec(a.normal) + w.y * vec(b.normal) + w.z * vec(c.normal);
    s.smooth = glm::dot(normal, normal) > 0;
    if (s.smooth) s.shading = glm::normalize(normal);
}

inline SurfacePoint surface_at(const World& world, const PathRay& ray, const PathHit& hit) {
    const Scene& scene = world.scene;
    SurfacePoint s;
    s.material = &world.material_of(hit.primitive);
    const vec3 p = ray.origin + hit.t * ray.direction;
    if (hit.primitive < scene.triangles.size()) {
        place_on_triangle(world, hit, s);
    } else if (const std::size_t index = hit.primitive - scene.triangles.size(); index < scene.spheres.size()) {
        const Sphere& sphere = scene.spheres[index];
        const vec3 center = vec(sphere.center);
        s.geometric = s.shading = glm::normalize(p - center);
        s.position = center + sphere.radius * s.geometric;
        // Twice the kernels' bound: Embree's test subtracts the square root of a difference.
        s.offset = 16 * ROUNDING * (sphere.radius + largest(center));
    } else {
        const Plane& plane = scene.planes[index - scene.spheres.size()];
        const vec3 normal = vec(plane.normal), point = vec(plane.point);
        s.geometric = s.shading = normal;
        s.position = p - glm::dot(normal, p - point) * normal;
        s.offset = 16 * ROUNDING * (largest(s.position) + largest(point));
    }
    s.inside = glm::dot(ray.direction, s.geometric) > 0;
    if (s.inside) {
        s.geometric = -s.geometric;
        s.shading = -s.shading;
    }
    return s;
}

/// Where a ray must start to leave on the side that the ray came from (side 1), or on the other (-1).
inline vec3 leave(const World& world, const SurfacePoint& s, float side) {
    return world.constants.robust_offset ? s.position + side * s.offset * s.geometric : s.position;
}

/// From the hit to the curved surface that the vertex normals describe: Hanika, "Hacking the Shadow Terminator", 2021.
inline vec3 smooth_lift(const World& world, const SurfacePoint& s) {
    vec3 lift(0);
    for (int corner = 0; corner < 3; ++corner) {
        const Vertex& vertex = world.scene.vertices[s.triangle->vertex[corner]];
        const vec3 normal = (s.inside ? -1.0f : 1.0f) * glm::normalize(vec(vertex.normal));
        const float below = glm::dot(s.position - vec(vertex.position), normal);
        lift += s.weights[corner] * std::max(-below, 0.0f) * normal;
    }
    return lift;
}

}  // namespace raymill::bench
