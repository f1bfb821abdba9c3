// What belongs to a primitive or a material of a scene.
#pragma once

#include <string>

#include "reference/reference.hpp"
#include "scene/scene.hpp"

namespace raymill::verify {

using glm::dvec3;

/// A queue's ray as the reference takes it.
inline reference::Ray reference_ray(const Ray& ray) {
    return {reference::to_dvec3(ray.origin), reference::to_dvec3(ray.direction)};
}
inline reference::Ray reference_ray(const ShadowRay& ray) {
    return {reference::to_dvec3(ray.origin), reference::to_dvec3(ray.direction)};
}
inline reference::Hit reference_hit(const Hit& hit) {
    return {hit.t, hit.u, hit.v, hit.primitive};
}

bool is_triangle(const Scene& scene, std::uint32_t primitive);
/// The sphere of a primitive id, or nullptr.
const Sphere* sphere_of(const Scene& scene, std::uint32_t primitive);
/// The plane of a primitive id, or nullptr.
const Plane* plane_of(const Scene& scene, std::uint32_t primitive);

std::uint32_t material_index(const Scene& scene, std::uint32_t primitive);
const SceneMaterial& material_of(const Scene& scene, std::uint32_t primitive);
/// By what a crossing of this primitive multiplies the light; zero where it blocks it.
dvec3 shadow_filter(const Scene& scene, std::uint32_t primitive);

/// "sphere "name"" of the object that the primitive belongs to.
std::string object_name(const Scene& scene, std::uint32_t primitive);
std::string material_name(const Scene& scene, std::uint32_t material);
/// The scene file's word: "point", "spot" ...
const char* light_type(const SceneLight& light);

/// Signed distance of a point from a primitive, positive on the side of its outward normal.
double height_above(const Scene& scene, std::uint32_t primitive, const dvec3& point);

}  // namespace raymill::verify
