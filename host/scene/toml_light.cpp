#include <fmt/format.h>

#include <algorithm>

#include "scene/shapes.hpp"
#include "scene/texture.hpp"
#include "scene/toml_reader.hpp"
#include "scene/toml_scene.hpp"

namespace raymill {
namespace {

enum class LightType { none, ambient, point, directional, spot, rectangle, disk, sphere, environment };

glm::vec3 attenuation(TableReader& reader) {
    glm::dvec3 value(1, 0, 0);
    if (!reader.numbers("attenuation", std::span(&value.x, 3))) return glm::vec3(value);
    if (value == glm::dvec3(0)) reader.error("attenuation", "must not be all zero");
    if (std::min({value.x, value.y, value.z}) < 0) reader.error("attenuation", "must not be negative");
    return glm::vec3(value);
}

AmbientLight read_ambient(TableReader& reader) {
    return {reader.color("color", glm::vec3(1))};
}

PointLight read_point(TableReader& reader) {
    reader.require({"position"});
    PointLight light;
    light.position = glm::vec3(reader.vector("position", glm::dvec3(0)));
    light.intensity = reader.color("intensity", light.intensity);
    light.attenuation = attenuation(reader);
    light.radius = reader.real("radius", light.radius, at_least(0));
    return light;
}

DirectionalLight read_directional(TableReader& reader) {
    reader.require({"direction"});
    DirectionalLight light;
    light.direction = glm::vec3(reader.direction("direction", glm::dvec3(0, -1, 0)));
    light.intensity = reader.color("intensity", light.intensity);
    return light;
}

SpotLight read_spot(TableReader& reader) {
    reader.require({"position", "direction"});
    SpotLight light;
    light.position = glm::vec3(reader.vector("position", glm::dvec3(0)));
    light.direction = glm::vec3(reader.direction("direction", glm::dvec3(0, -1, 0)));
    light.intensity = reader.color("intensity", light.intensity);
    light.attenuation = attenuation(reader);
    Range outer = between(0, 90);
    outer.open_lower = true;
    light.outer_angle = reader.real("outer_angle", light.outer_angle, outer);
    light.inner_angle = reader.real("inner_angle", light.inner_angle, between(0, 90));
    if (light.inner_angle > light.outer_angle)
        reader.error("inner_angle", fmt::format("must not exceed outer_angle ({})", light.outer_angle));
    return light;
}

RectangleLight read_rectangle(TableReader& reader) {
    const bool complete = reader.require({"center", "edge_u", "edge_v"});
    RectangleLight light;
    const glm::dvec3 u = reader.vector("edge_u", glm::dvec3(light.edge_u));
    const glm::dvec3 v = reader.vector("edge_v", glm::dvec3(light.edge_v));
    light.center = glm::vec3(reader.vector("center", glm::dvec3(0)));
    light.edge_u = glm::vec3(u);
    light.edge_v = glm::vec3(v);
    light.radiance = reader.color("radiance", light.radiance);
    if (complete && !(glm::length(glm::cross(u, v)) > 1e-9 * glm::length(u) * glm::length(v)))
        reader.error("edge_u", "and edge_v must span an area: they are zero or parallel");
    return light;
}

DiskLight read_disk(TableReader& reader) {
    reader.require({"center", "normal", "radius"});
    DiskLight light;
    light.center = glm::vec3(reader.vector("center", glm::dvec3(0)));
    light.normal = glm::vec3(reader.direction("normal", glm::dvec3(0, -1, 0)));
    light.radius = reader.real("radius", light.radius, above(0));
    light.radiance = reader.color("radiance", light.radiance);
    return light;
}

SphereLight read_sphere(TableReader& reader) {
    reader.require({"center", "radius"});
    SphereLight light;
    light.center = glm::vec3(reader.vector("center", glm::dvec3(0)));
    light.radius = reader.real("radius", light.radius, above(0));
    light.radiance = reader.color("radiance", light.radiance);
    return light;
}

EnvironmentLight read_environment(TableReader& reader) {
    EnvironmentLight light;
    light.radiance = reader.color("radiance", light.radiance);
    const std::string map = reader.text("map");
    if (map.empty()) return light;
    light.map = load_texture(reader.loading(), path_beside(reader.file(), map), reader.position_of("map"), false);
    return light;
}

/// Makes an object for the light's geometry, light.object, and returns the material that makes it shine.
std::uint32_t new_emitter(Scene& scene, SceneLight& light, const std::string& shape, const glm::vec3& radiance,
                          bool one_sided, double chord_error) {
    SceneMaterial material;
    material.name = shape + " light";
    material.diffuse = glm::vec3(0);
    material.emission = radiance;
    material.one_sided_emission = one_sided;
    scene.materials.push_back(material);
    light.object = static_cast<std::uint32_t>(scene.objects.size());
    scene.objects.push_back({shape + " light", shape, chord_error});
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

}  // namespace

void read_light(TableReader& reader) {
    if (!reader.require({"type"})) return reader.ignore_other_keys();
    const LightType type = reader.choice("type", LightType::none,
                                         {{"ambient", LightType::ambient},
                                          {"point", LightType::point},
                                          {"directional", LightType::directional},
                                          {"spot", LightType::spot},
                                          {"rectangle", LightType::rectangle},
                                          {"disk", LightType::disk},
                                          {"sphere", LightType::sphere},
                                          {"environment", LightType::environment}});
    reader.text("name");
    SceneLight light;
    const bool has_extent = type == LightType::rectangle || type == LightType::disk || type == LightType::sphere;
    if (type != LightType::ambient && type != LightType::environment)
        light.samples = static_cast<std::uint32_t>(reader.integer("samples", 1, 1, 1024));
    if (has_extent) light.visible = reader.boolean("visible", true);
    switch (type) {
        case LightType::none:
            return reader.ignore_other_keys();
        case LightType::ambient:
            light.light = read_ambient(reader);
            break;
        case LightType::point:
            light.light = read_point(reader);
            break;
        case LightType::directional:
            light.light = read_directional(reader);
            break;
        case LightType::spot:
            light.light = read_spot(reader);
            break;
        case LightType::rectangle:
            light.light = read_rectangle(reader);
            break;
        case LightType::disk:
            light.light = read_disk(reader);
            break;
        case LightType::sphere:
            light.light = read_sphere(reader);
            break;
        case LightType::environment:
            light.light = read_environment(reader);
            break;
    }
    reader.loading().scene.lights.push_back(light);
}

void add_light_geometry(Scene& scene) {
    for (SceneLight& light : scene.lights) {
        if (!light.visible) continue;
        if (const auto* rectangle = std::get_if<RectangleLight>(&light.light)) {
            const std::uint32_t material = new_emitter(scene, light, "rectangle", rectangle->radiance, true, 0);
            const IndexedMesh mesh = rectangle_mesh(glm::dvec3(rectangle->center), glm::dvec3(rectangle->edge_u),
                                                    glm::dvec3(rectangle->edge_v));
            append_mesh(scene, mesh, {}, material, light.object);
        } else if (const auto* disk = std::get_if<DiskLight>(&light.light)) {
            const IndexedMesh mesh = disk_mesh(glm::dvec3(disk->center), glm::dvec3(disk->normal), disk->radius);
            const std::uint32_t material = new_emitter(scene, light, "disk", disk->radiance, true, mesh.chord_error);
            append_mesh(scene, mesh, {}, material, light.object);
        } else if (const auto* sphere = std::get_if<SphereLight>(&light.light)) {
            const std::uint32_t material = new_emitter(scene, light, "sphere", sphere->radiance, false, 0);
            const glm::vec3& c = sphere->center;
            scene.spheres.push_back({{c.x, c.y, c.z}, sphere->radius, material, light.object});
        }
    }
}

}  // namespace raymill
