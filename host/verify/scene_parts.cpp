#include "verify/scene_parts.hpp"

#include <fmt/format.h>

namespace raymill::verify {

namespace {

const uint& object_index(const Scene& scene, std::uint32_t primitive) {
    if (is_triangle(scene, primitive)) return scene.triangles[primitive].object;
    if (const Sphere* sphere = sphere_of(scene, primitive)) return sphere->object;
    return plane_of(scene, primitive)->object;
}

}  // namespace

bool is_triangle(const Scene& scene, std::uint32_t primitive) {
    return primitive < scene.triangles.size();
}

const Sphere* sphere_of(const Scene& scene, std::uint32_t primitive) {
    const std::size_t index = std::size_t{primitive} - scene.triangles.size();
    return index < scene.spheres.size() ? &scene.spheres[index] : nullptr;
}

const Plane* plane_of(const Scene& scene, std::uint32_t primitive) {
    const std::size_t index = std::size_t{primitive} - scene.triangles.size() - scene.spheres.size();
    return index < scene.planes.size() ? &scene.planes[index] : nullptr;
}

std::uint32_t material_index(const Scene& scene, std::uint32_t primitive) {
    if (is_triangle(scene, primitive)) return scene.triangles[primitive].material;
    if (const Sphere* sphere = sphere_of(scene, primitive)) return sphere->material;
    return plane_of(scene, primitive)->material;
}

const SceneMaterial& material_of(const Scene& scene, std::uint32_t primitive) {
    return scene.materials[material_index(scene, primitive)];
}

dvec3 shadow_filter(const Scene& scene, std::uint32_t primitive) {
    const SceneMaterial& material = material_of(scene, primitive);
    if (scene.settings.shadows == ShadowMode::opaque) return dvec3(0);
    return static_cast<double>(material.transmission) * dvec3(material.base_color);
}

std::string object_name(const Scene& scene, std::uint32_t primitive) {
    const std::uint32_t index = object_index(scene, primitive);
    if (index >= scene.objects.size()) return fmt::format("object {}", index + 1);
    const SceneObject& object = scene.objects[index];
    return object.name.empty() || object.name == object.shape ? fmt::format("{} (object {})", object.shape, index + 1)
                                                              : fmt::format("{} \"{}\"", object.shape, object.name);
}

std::string material_name(const Scene& scene, std::uint32_t material) {
    const std::string& name = scene.materials[material].name;
    if (name.empty()) return material == 0 ? "the default material" : fmt::format("material {}", material);
    return fmt::format("material \"{}\"", name);
}

const char* light_type(const SceneLight& light) {
    constexpr const char* names[] = {"ambient",   "point", "directional", "spot",
                                     "rectangle", "disk",  "sphere",      "environment"};
    return names[light.light.index()];
}

double height_above(const Scene& scene, std::uint32_t primitive, const dvec3& point) {
    if (is_triangle(scene, primitive)) {
        const Triangle& triangle = scene.triangles[primitive];
        const auto corner = [&](int i) { return reference::to_dvec3(scene.vertices[triangle.vertex[i]].position); };
        const dvec3 a = corner(0);
        return glm::dot(point - a, glm::normalize(glm::cross(corner(1) - a, corner(2) - a)));
    }
    if (const Sphere* sphere = sphere_of(scene, primitive))
        return glm::length(point - reference::to_dvec3(sphere->center)) - sphere->radius;
    const Plane* plane = plane_of(scene, primitive);
    return glm::dot(point - reference::to_dvec3(plane->point), glm::normalize(reference::to_dvec3(plane->normal)));
}

}  // namespace raymill::verify
