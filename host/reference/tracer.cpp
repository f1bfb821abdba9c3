// The recursion: camera rays, and what each ray brings home.
// Source: Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980.
#include <algorithm>
#include <cmath>

#include "lib/random.h"
#include "reference/formulas.hpp"
#include "reference/reference.hpp"

namespace raymill::reference {

Ray Tracer::camera_ray(int x, int y, std::uint32_t sample) const {
    const RenderSettings& settings = scene_.settings;
    const Camera& camera = scene_.camera;
    const auto spp = static_cast<std::uint32_t>(settings.spp);
    const std::uint32_t path = path_camera(settings.seed, static_cast<std::uint32_t>(y * settings.width + x));
    const dvec2 in_pixel = spp == 1 ? dvec2(0.5) : stratified_square(sample, random_key(path, RANDOM_PIXEL));

    const dvec3 forward = glm::normalize(camera.look_at - camera.eye);
    const dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const dvec3 up = glm::cross(right, forward);
    const bool orthographic = camera.projection == Projection::orthographic;
    const double half_height = orthographic ? camera.height / 2 : std::tan(glm::radians(camera.fov) / 2);
    const double half_width = half_height * settings.width / settings.height;
    const dvec3 on_film = (2 * (x + in_pixel.x) / settings.width - 1) * half_width * right +
                          (1 - 2 * (y + in_pixel.y) / settings.height) * half_height * up;

    Ray ray{camera.eye, forward};  // the direction reaches unit distance along the viewing axis
    (orthographic ? ray.origin : ray.direction) += on_film;
    if (camera.aperture > 0) {
        const double focus = camera.focus > 0 ? camera.focus : glm::length(camera.look_at - camera.eye);
        const dvec3 in_focus = ray.origin + focus * ray.direction;
        const dvec2 lens =
            camera.aperture / 2 * concentric_disk(stratified_square(sample, random_key(path, RANDOM_LENS)));
        ray.origin += lens.x * right + lens.y * up;
        ray.direction = in_focus - ray.origin;
    }
    ray.direction = glm::normalize(ray.direction);
    return ray;
}

dvec3 Tracer::direct_light(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t sample,
                           std::uint32_t path) const {
    dvec3 sum(0);
    for (std::uint32_t light = 0; light < scene_.lights.size(); ++light) {
        for (std::uint32_t i = 0; i < scene_.lights[light].samples; ++i) {
            const LocalTerms terms = local_terms(ray, hit, surface, light, i, sample, path);
            const dvec3 unshadowed = terms.diffuse + terms.specular;
            if (unshadowed == dvec3(0)) continue;
            const LightSample s = sample_light(light, i, surface.position, sample, path);
            sum += unshadowed * visibility(shadow_ray(ray, hit, surface, s), s.shadow_distance);
        }
    }
    return sum;
}

dvec3 Tracer::shade(const Ray& ray, const Hit& hit, int depth, std::uint32_t sample, std::uint32_t path,
                    const dvec3& throughput) const {
    const Surface s = surface(ray, hit);
    const SceneMaterial& material = scene_.materials[s.material];
    const Split parts = split(ray, s);
    const double length = hit.t * glm::length(ray.direction);
    const dvec3 absorbed = s.inside ? glm::exp(-length * dvec3(material.absorption)) : dvec3(1);

    dvec3 sum = emission(s);
    if (parts.local > 0) sum += parts.local * (ambient_term(s) + direct_light(ray, hit, s, sample, path));
    const auto add_child = [&](double weight, const dvec3& direction, std::uint32_t branch) {
        const dvec3 color = weight * dvec3(material.base_color);
        const dvec3 child = throughput * absorbed * color;
        const double strongest = std::max({child.x, child.y, child.z});
        if (strongest == 0 || strongest < scene_.settings.min_weight) return;
        sum += color * trace(spawn(ray, hit, s, direction), depth + 1, sample, path_child(path, branch), child);
    };
    if (depth < scene_.settings.depth) {
        add_child(parts.reflection, parts.reflected, 0);
        add_child(parts.transmission, parts.refracted, 1);
    }
    return absorbed * sum;
}

dvec3 Tracer::trace(const Ray& ray, int depth, std::uint32_t sample, std::uint32_t path,
                    const dvec3& throughput) const {
    const Hit hit = intersect(ray);
    if (hit.primitive == NO_INDEX) return background(glm::normalize(ray.direction));
    return shade(ray, hit, depth, sample, path, throughput);
}

dvec3 Tracer::radiance(const Ray& ray, int depth, std::uint32_t sample, std::uint32_t path) const {
    return trace(ray, depth, sample, path, dvec3(1));
}

glm::dvec4 Tracer::pixel(int x, int y) const {
    const RenderSettings& settings = scene_.settings;
    const auto spp = static_cast<std::uint32_t>(settings.spp);
    const std::uint32_t path = path_camera(settings.seed, static_cast<std::uint32_t>(y * settings.width + x));
    glm::dvec4 sum(0);
    for (std::uint32_t sample = 0; sample < spp; ++sample) {
        const Ray ray = camera_ray(x, y, sample);
        const Hit hit = intersect(ray);
        if (hit.primitive == NO_INDEX) {
            sum += glm::dvec4(background(ray.direction), 0);
        } else {
            sum += glm::dvec4(shade(ray, hit, 0, sample, path, dvec3(1)), 1);
        }
    }
    return sum / static_cast<double>(spp);
}

}  // namespace raymill::reference
