#include "verify/surface_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

double largest(const dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

SurfaceBounds triangle_bounds(const Scene& scene, const reference::Hit& hit) {
    const Triangle& triangle = scene.triangles[hit.primitive];
    dvec3 p[3], n[3];
    double size = 0, uv = 0, normals = 0;
    for (int i = 0; i < 3; ++i) {
        const Vertex& vertex = scene.vertices[triangle.vertex[i]];
        p[i] = reference::to_dvec3(vertex.position);
        n[i] = reference::to_dvec3(vertex.normal);
        size = std::max(size, largest(p[i]));
        normals = std::max(normals, largest(n[i]));
        uv = std::max({uv, std::abs(double{vertex.uv[0]}), std::abs(double{vertex.uv[1]})});
    }
    SurfaceBounds b;
    // The first weight is 1 - u - v: two roundings; the sum of three products has three more, the weights' sum one.
    b.position = 6 * rounding * size;
    b.offset = 16 * rounding * size + diagonal * (b.position + rounding * size);
    b.uv = 6 * rounding * uv;
    // Each edge is rounded once, so are the inner product and the result of each fused difference: with the three
    // coordinates below 6 roundings of the edges' product. Normalising adds five.
    const dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
    const double area = glm::length(glm::cross(e1, e2));
    b.geometric_normal = rounding * (6 * glm::length(e1) * glm::length(e2) / area + 5);
    // Interpolated like the position, over the length of what is normalised.
    const double length = glm::length((1 - hit.u - hit.v) * n[0] + hit.u * n[1] + hit.v * n[2]);
    b.shading_normal = std::max(b.geometric_normal, rounding * (6 * diagonal * normals / length + 5));
    if (!(length > 0)) b.shading_normal = b.geometric_normal;
    return b;
}

SurfaceBounds sphere_bounds(const Sphere& sphere, const dvec3& hit_point) {
    const dvec3 center = reference::to_dvec3(sphere.center);
    SurfaceBounds b;
    // The hit point is rounded once, its difference to the centre once more; normalising adds five.
    b.geometric_normal = rounding * (diagonal * largest(hit_point) / glm::length(hit_point - center) + diagonal + 5);
    b.shading_normal = b.geometric_normal;
    b.position = sphere.radius * b.geometric_normal + rounding * (largest(center) + sphere.radius);
    b.offset = 8 * rounding * (sphere.radius + largest(center)) +
               diagonal * (b.position + rounding * (largest(center) + sphere.radius));
    return b;
}

SurfaceBounds plane_bounds(const Plane& plane, const dvec3& hit_point, const dvec3& position) {
    const dvec3 point = reference::to_dvec3(plane.point);
    SurfaceBounds b;
    b.geometric_normal = b.shading_normal = 4 * rounding;  // the stored normal is rounded, and not normalised again
    // The hit point is rounded, its difference to the plane's point too; their inner product has four roundings.
    b.position = rounding * (3 * largest(hit_point) + 6 * glm::length(hit_point - point));
    b.offset = 16 * rounding * (largest(position) + largest(point)) + diagonal * b.position + 2 * b.position;
    return b;
}

}  // namespace

SurfaceBounds surface_bounds(const Scene& scene, const reference::Ray& ray, const reference::Hit& hit,
                             const reference::Surface& surface) {
    const dvec3 hit_point = ray.origin + hit.t * ray.direction;
    SurfaceBounds b;
    if (is_triangle(scene, hit.primitive))
        b = triangle_bounds(scene, hit);
    else if (const Sphere* sphere = sphere_of(scene, hit.primitive))
        b = sphere_bounds(*sphere, hit_point);
    else
        b = plane_bounds(*plane_of(scene, hit.primitive), hit_point, surface.position);
    b.facing = std::abs(glm::dot(ray.direction, surface.geometric_normal)) / (b.geometric_normal + 4 * rounding);
    return b;
}

}  // namespace raymill::verify
