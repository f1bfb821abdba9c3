// Queue items and scenes as tests write them.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "bvh/meshes.hpp"
#include "reference/reference.hpp"
#include "scene/scene.hpp"

namespace raymill::test {

inline constexpr double ROUNDING = 0x1p-24;  // half a unit in the last place of one, relative

inline void store(float (&to)[3], const glm::vec3& from) {
    for (int k = 0; k < 3; ++k) to[k] = from[k];
}

inline glm::vec3 vec3_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// A camera ray of its own pixel, sample 0, weight 1.
inline Ray make_ray(const glm::vec3& origin, const glm::vec3& direction, uint pixel = 0) {
    Ray ray{};
    store(ray.origin, origin);
    store(ray.direction, direction);
    store(ray.throughput, glm::vec3(1));
    ray.pixel = pixel;
    ray.path = 0x9e3779b9u * (pixel + 1);
    ray.route = ROUTE_CAMERA;
    return ray;
}

/// From a to b, unit but for rounding.
inline glm::vec3 towards(const glm::dvec3& from, const glm::dvec3& to) {
    return glm::vec3(glm::normalize(to - from));
}

inline reference::Ray exact(const Ray& ray) {
    return {reference::to_dvec3(ray.origin), reference::to_dvec3(ray.direction)};
}

inline reference::Hit exact(const Hit& hit) {
    return {hit.t, hit.u, hit.v, hit.primitive};
}

/// What the film adds for a value: units of 2^-32, to the nearest integer.
inline std::int64_t film_units(float value) {
    return static_cast<std::int64_t>(std::nearbyint(static_cast<double>(value) * 0x1p32));
}

inline Scene scene_of(const Mesh& mesh) {
    Scene scene;
    scene.materials.emplace_back();
    scene.vertices = mesh.vertices;
    scene.triangles = mesh.triangles;
    scene.spheres = mesh.spheres;
    return scene;
}

inline void add_plane(Scene& scene, const glm::vec3& point, const glm::vec3& normal, uint material = 0) {
    Plane plane{};
    store(plane.point, point);
    store(plane.normal, normal);
    plane.material = material;
    scene.planes.push_back(plane);
}

inline void add_sphere(Scene& scene, const glm::vec3& center, float radius, uint material = 0) {
    scene.spheres.push_back({{center.x, center.y, center.z}, radius, material, 0});
}

/// A sphere of triangles around `center`, by `levels` subdivisions of an icosahedron; vertices are shared, outside
/// counter-clockwise.
Mesh icosphere(int levels, float radius, const glm::vec3& center);

/// Twelve triangles that share eight vertices.
Mesh box(const glm::vec3& lower, const glm::vec3& upper);

/// A hierarchy that culls nothing: boxes are infinite, so that every primitive meets every ray by the kernels' own
/// arithmetic. Primitives with coordinates that are not finite are left out, as build_bvh does.
Bvh uncullable_bvh(const Scene& scene);

}  // namespace raymill::test
