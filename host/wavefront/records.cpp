#include "wavefront/records.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace raymill {

namespace {

void store(float (&out)[3], glm::vec3 v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};

glm::vec3 unit(glm::vec3 v) { return glm::vec3(glm::normalize(glm::dvec3(v))); }

/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017, as in the kernels.
void tangents(glm::dvec3 n, glm::dvec3& t, glm::dvec3& u) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    t = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    u = {b, sign + n.y * n.y * a, -n.y};
}

/// glTF 2.0, KHR_lights_punctual, "Inner and Outer Cone Angles".
void set_cone(LightRecord& record, double inner_degrees, double outer_degrees) {
    const double inner = std::cos(glm::radians(inner_degrees)), outer = std::cos(glm::radians(outer_degrees));
    const double scale = 1 / std::max(0.001, inner - outer);
    record.cone_scale = static_cast<float>(scale);
    record.cone_offset = static_cast<float>(-outer * scale);
}

LightRecord light_record(const SceneLight& scene_light) {
    LightRecord r{};
    r.samples = scene_light.samples;
    r.attenuation[0] = 1;
    std::visit(Overloaded{
                   [](const AmbientLight&) {},
                   [](const EnvironmentLight&) {},
                   [&](const PointLight& light) {
                       r.type = LIGHT_POINT;
                       store(r.position, light.position);
                       store(r.intensity, light.intensity);
                       store(r.attenuation, light.attenuation);
                       r.radius = light.radius;
                   },
                   [&](const DirectionalLight& light) {
                       r.type = LIGHT_DIRECTIONAL;
                       store(r.normal, unit(light.direction));
                       store(r.intensity, light.intensity);
                   },
                   [&](const SpotLight& light) {
                       r.type = LIGHT_SPOT;
                       store(r.position, light.position);
                       store(r.normal, unit(light.direction));
                       store(r.intensity, light.intensity);
                       store(r.attenuation, light.attenuation);
                       set_cone(r, light.inner_angle, light.outer_angle);
                   },
                   [&](const RectangleLight& light) {
                       r.type = LIGHT_RECTANGLE;
                       const glm::dvec3 across = glm::cross(glm::dvec3(light.edge_u), glm::dvec3(light.edge_v));
                       store(r.position, light.center);
                       store(r.normal, glm::vec3(glm::normalize(across)));
                       store(r.axis_u, light.edge_u);
                       store(r.axis_v, light.edge_v);
                       store(r.intensity, light.radiance);
                       r.area = static_cast<float>(glm::length(across));
                   },
                   [&](const DiskLight& light) {
                       r.type = LIGHT_DISK;
                       const glm::dvec3 normal = glm::normalize(glm::dvec3(light.normal));
                       const double radius = light.radius;
                       glm::dvec3 t, u;
                       tangents(normal, t, u);
                       store(r.position, light.center);
                       store(r.normal, glm::vec3(normal));
                       store(r.axis_u, glm::vec3(radius * t));
                       store(r.axis_v, glm::vec3(radius * u));
                       store(r.intensity, light.radiance);
                       r.area = static_cast<float>(glm::pi<double>() * radius * radius);
                   },
                   [&](const SphereLight& light) {
                       r.type = LIGHT_SPHERE;
                       store(r.position, light.center);
                       store(r.intensity, light.radiance);
                       r.radius = light.radius;
                   },
               },
               scene_light.light);
    return r;
}

Material material_record(const SceneMaterial& m) {
    Material r{};
    store(r.ambient, m.ambient);
    store(r.diffuse, m.diffuse_checker ? m.diffuse_checker->a : m.diffuse);
    store(r.specular, m.specular);
    store(r.emission, m.emission);
    store(r.base_color, m.base_color);
    store(r.absorption, m.absorption);
    r.shininess = m.shininess;
    r.reflection = m.reflection;
    r.transmission = m.transmission;
    r.ior = m.ior;
    r.exterior_ior = m.exterior_ior;
    r.diffuse_texture = m.diffuse_map.value_or(NO_INDEX);
    r.checker_scale = 1;
    if (m.diffuse_checker) {
        store(r.checker, m.diffuse_checker->b);
        r.checker_scale = m.diffuse_checker->scale;
        r.flags |= MATERIAL_CHECKER;
    }
    if (m.highlight == Highlight::blinn) r.flags |= MATERIAL_BLINN;
    if (m.shading == Shading::flat) r.flags |= MATERIAL_FLAT;
    if (m.shading == Shading::gouraud) r.flags |= MATERIAL_GOURAUD;
    if (m.fresnel) r.flags |= MATERIAL_FRESNEL;
    if (m.one_sided_emission) r.flags |= MATERIAL_ONE_SIDED;
    if (m.absorption != glm::vec3(0)) r.flags |= MATERIAL_ABSORBING;
    return r;
}

}  // namespace

std::vector<Material> material_records(const Scene& scene) {
    std::vector<Material> records;
    for (const SceneMaterial& material : scene.materials) records.push_back(material_record(material));
    return records;
}

std::vector<LightRecord> light_records(const Scene& scene) {
    std::vector<LightRecord> records;
    for (const SceneLight& light : scene.lights) records.push_back(light_record(light));
    return records;
}

std::vector<LightSlot> light_slots(const Scene& scene) {
    std::vector<LightSlot> slots;
    for (uint i = 0; i < scene.lights.size(); ++i) {
        const SceneLight& light = scene.lights[i];
        if (std::holds_alternative<AmbientLight>(light.light) || std::holds_alternative<EnvironmentLight>(light.light))
            continue;
        for (uint sample = 0; sample < light.samples; ++sample) slots.push_back({i, sample});
    }
    return slots;
}

CameraRecord camera_record(const Scene& scene) {
    const Camera& camera = scene.camera;
    const RenderSettings& settings = scene.settings;
    const PixelWindow window = crop_window(settings);
    const glm::dvec3 forward = glm::normalize(camera.look_at - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const glm::dvec3 up = glm::cross(right, forward);
    const bool orthographic = camera.projection == Projection::orthographic;
    const double half_height = orthographic ? camera.height / 2 : std::tan(glm::radians(camera.fov) / 2);
    const double half_width = half_height * settings.width / settings.height;

    CameraRecord r{};
    store(r.eye, glm::vec3(camera.eye));
    store(r.forward, glm::vec3(forward));
    store(r.right, glm::vec3(right * half_width));
    store(r.up, glm::vec3(up * half_height));
    r.lens_radius = static_cast<float>(camera.aperture / 2);
    r.focus = static_cast<float>(camera.focus > 0 ? camera.focus : glm::length(camera.look_at - camera.eye));
    r.orthographic = orthographic;
    r.width = static_cast<uint>(settings.width);
    r.height = static_cast<uint>(settings.height);
    r.crop[0] = static_cast<uint>(window.x0);
    r.crop[1] = static_cast<uint>(window.y0);
    r.crop[2] = static_cast<uint>(window.width);
    r.crop[3] = static_cast<uint>(window.height);
    r.spp = static_cast<uint>(settings.spp);
    r.seed = settings.seed;
    return r;
}

SceneConstants scene_constants(const Scene& scene, std::size_t node_count, const FilmPlanes& planes) {
    const RenderSettings& settings = scene.settings;
    SceneConstants r{};
    glm::vec3 ambient{0}, background(settings.background);
    r.environment = NO_INDEX;
    for (const SceneLight& light : scene.lights) {
        if (const auto* a = std::get_if<AmbientLight>(&light.light)) ambient += a->color;
        if (const auto* e = std::get_if<EnvironmentLight>(&light.light)) {
            if (e->map) {
                r.environment = *e->map;
                store(r.environment_scale, e->radiance);
            } else {
                background += e->radiance;
            }
        }
    }
    store(r.background, background);
    store(r.ambient, ambient);
    r.triangle_count = static_cast<uint>(scene.triangles.size());
    r.sphere_count = static_cast<uint>(scene.spheres.size());
    r.plane_count = static_cast<uint>(scene.planes.size());
    r.node_count = static_cast<uint>(node_count);
    r.shadows = settings.shadows == ShadowMode::filtered ? SHADOWS_FILTERED
                : settings.shadows == ShadowMode::opaque ? SHADOWS_OPAQUE
                                                         : SHADOWS_NONE;
    r.robust_offset = settings.shadow_offset == ShadowOffset::robust;
    r.min_weight = static_cast<float>(settings.min_weight);
    r.any_filter = std::ranges::any_of(scene.materials, [](const SceneMaterial& m) { return m.transmission > 0; });
    for (int plane = 0; plane < FILM_PLANES; ++plane)
        r.plane[plane] = planes.keeps(plane) ? planes.index(plane) : 0;
    r.film_pixels = static_cast<uint>(film_pixels(scene));
    return r;
}

std::uint64_t film_pixels(const Scene& scene) {
    const PixelWindow window = crop_window(scene.settings);
    return static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
}

std::uint64_t camera_samples(const Scene& scene) {
    return film_pixels(scene) * static_cast<std::uint64_t>(scene.settings.spp);
}

bool spawns_secondary_rays(const Scene& scene) {
    return std::ranges::any_of(scene.materials,
                               [](const SceneMaterial& m) { return m.reflection > 0 || m.transmission > 0; });
}

}  // namespace raymill
