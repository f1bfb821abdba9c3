// Brute-force visibility and the surface at a hit.
#include <algorithm>
#include <cmath>
#include <optional>

#include "reference/primitives.hpp"
#include "reference/reference.hpp"

namespace raymill::reference {

namespace {

double largest(const dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The far end of the chord through a sphere of a ray that starts on it; nothing for a ray that leaves it.
std::optional<double> chord_from(const Ray& ray, const dvec3& center) {
    const dvec3& d = ray.direction;
    const double t = -2 * glm::dot(ray.origin - center, d) / glm::dot(d, d);
    return t > 0 ? std::optional(t) : std::nullopt;
}

/// The first of the two ends beyond t_min, or infinity.
double first_beyond(const SphereHits& ends, double t_min) {
    if (ends.near > t_min) return ends.near;
    return ends.far > t_min ? ends.far : INFINITY;
}

}  // namespace

Tracer::Tracer(const Scene& scene) : scene_(scene) {
    corners_.reserve(scene.triangles.size());
    for (const Triangle& triangle : scene.triangles) {
        Corners corners;
        for (int i = 0; i < 3; ++i) corners[i] = to_dvec3(scene.vertices[triangle.vertex[i]].position);
        const dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double length2 = glm::dot(normal, normal);
        // What has no area or is not finite has no normal either: three equal corners are never hit.
        if (!(length2 > 0 && length2 < INFINITY)) corners.fill(dvec3(0));
        corners_.push_back(corners);
    }
}

Hit Tracer::intersect_primitive(const Ray& ray, std::uint32_t primitive, double t_min) const {
    const auto triangles = static_cast<std::uint32_t>(corners_.size());
    const auto spheres = static_cast<std::uint32_t>(scene_.spheres.size());
    const double beyond = std::max(t_min, ray.clearance);
    const Caster caster(ray.origin, ray.direction);
    if (primitive < triangles) {
        if (primitive == ray.from) return {};
        const auto hit = caster.triangle(corners_[primitive], Border::closed);
        return hit && hit->t > beyond ? Hit{hit->t, hit->u, hit->v, primitive} : Hit{};
    }
    if (primitive < triangles + spheres) {
        const Sphere& sphere = scene_.spheres[primitive - triangles];
        const dvec3 center = to_dvec3(sphere.center);
        if (primitive == ray.from) {
            const auto t = chord_from(ray, center);
            return t && *t > t_min ? Hit{*t, 0, 0, primitive} : Hit{};
        }
        const auto ends = caster.sphere(center, sphere.radius);
        const double t = ends ? first_beyond(*ends, beyond) : INFINITY;
        return t < INFINITY ? Hit{t, 0, 0, primitive} : Hit{};
    }
    const Plane& plane = scene_.planes[primitive - triangles - spheres];
    const auto t = caster.plane(to_dvec3(plane.point), to_dvec3(plane.normal));
    return t && *t > beyond && primitive != ray.from ? Hit{*t, 0, 0, primitive} : Hit{};
}

Hit Tracer::intersect(const Ray& ray, double t_min) const {
    Hit closest;
    const double beyond = std::max(t_min, ray.clearance);
    const Caster caster(ray.origin, ray.direction);
    const auto triangles = static_cast<std::uint32_t>(corners_.size());
    for (std::uint32_t id = 0; id < triangles; ++id) {
        const auto hit = caster.triangle(corners_[id], Border::closed);
        if (hit && hit->t > beyond && hit->t < closest.t && id != ray.from) closest = {hit->t, hit->u, hit->v, id};
    }
    for (std::uint32_t id = triangles; id < scene_.primitive_count(); ++id) {
        const Hit hit = intersect_primitive(ray, id, t_min);
        if (hit.t < closest.t) closest = hit;
    }
    return closest;
}

const SceneMaterial& Tracer::material_of(std::uint32_t primitive) const {
    std::size_t i = primitive;
    if (i < scene_.triangles.size()) return scene_.materials[scene_.triangles[i].material];
    i -= scene_.triangles.size();
    if (i < scene_.spheres.size()) return scene_.materials[scene_.spheres[i].material];
    return scene_.materials[scene_.planes[i - scene_.spheres.size()].material];
}

bool Tracer::is_flat(std::uint32_t primitive) const {
    if (primitive >= scene_.triangles.size()) return false;
    const Triangle& triangle = scene_.triangles[primitive];
    if (scene_.materials[triangle.material].shading == Shading::flat) return true;
    return std::any_of(std::begin(triangle.vertex), std::end(triangle.vertex),
                       [&](uint v) { return to_dvec3(scene_.vertices[v].normal) == dvec3(0); });
}

Surface Tracer::surface(const Ray& ray, const Hit& hit) const {
    Surface s;
    std::size_t i = hit.primitive;
    if (i < corners_.size()) {
        const Triangle& triangle = scene_.triangles[i];
        const Corners& p = corners_[i];
        const dvec3 weights(1 - hit.u - hit.v, hit.u, hit.v);
        s.position = p[0] + hit.u * (p[1] - p[0]) + hit.v * (p[2] - p[0]);
        s.geometric_normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
        dvec3 normal(0);
        for (int k = 0; k < 3; ++k) {
            const Vertex& vertex = scene_.vertices[triangle.vertex[k]];
            normal += weights[k] * to_dvec3(vertex.normal);
            s.uv += weights[k] * dvec2(vertex.uv[0], vertex.uv[1]);
        }
        const double length = glm::length(normal);
        s.smooth = !is_flat(hit.primitive) && length > 0;
        s.shading_normal = s.smooth ? normal / length : s.geometric_normal;
        s.material = triangle.material;
        s.object = triangle.object;
    } else if ((i -= corners_.size()) < scene_.spheres.size()) {
        const Sphere& sphere = scene_.spheres[i];
        const dvec3 center = to_dvec3(sphere.center);
        s.geometric_normal = s.shading_normal = glm::normalize(ray.origin + hit.t * ray.direction - center);
        s.position = center + static_cast<double>(sphere.radius) * s.geometric_normal;
        s.material = sphere.material;
        s.object = sphere.object;
    } else {
        const Plane& plane = scene_.planes[i - scene_.spheres.size()];
        s.geometric_normal = s.shading_normal = glm::normalize(to_dvec3(plane.normal));
        const dvec3 p = ray.origin + hit.t * ray.direction;
        s.position = p - glm::dot(p - to_dvec3(plane.point), s.geometric_normal) * s.geometric_normal;
        s.material = plane.material;
        s.object = plane.object;
    }
    s.inside = glm::dot(ray.direction, s.geometric_normal) > 0;
    return s;
}

// Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021, chapter 4.
dvec3 Tracer::smooth_lift(const Hit& hit, const Surface& surface) const {
    const dvec3 weights(1 - hit.u - hit.v, hit.u, hit.v);
    dvec3 lift(0);
    for (int k = 0; k < 3; ++k) {
        const Vertex& vertex = scene_.vertices[scene_.triangles[hit.primitive].vertex[k]];
        const dvec3 normal = (surface.inside ? -1.0 : 1.0) * glm::normalize(to_dvec3(vertex.normal));
        lift += weights[k] * std::max(0.0, -glm::dot(surface.position - corners_[hit.primitive][k], normal)) * normal;
    }
    return lift;
}

Ray Tracer::shadow_ray(const Ray& ray, const Hit& hit, const Surface& surface, const LightSample& light) const {
    Ray shadow = spawn(ray, hit, surface, light.direction);
    if (!surface.smooth) return shadow;
    const dvec3 lift = smooth_lift(hit, surface);
    shadow.origin += lift;
    // Towards the same point of the light, at the same multiple of the direction.
    if (std::isfinite(light.distance)) shadow.direction -= lift / light.distance;
    // From above, the triangle itself may stand in the way.
    if (glm::dot(shadow.direction, (surface.inside ? -1.0 : 1.0) * surface.geometric_normal) < 0) shadow.from = NO_INDEX;
    return shadow;
}

Ray Tracer::spawn(const Ray& ray, const Hit& hit, const Surface& surface, const dvec3& direction) const {
    double size = std::max(largest(surface.position), largest(ray.origin));
    std::size_t i = hit.primitive;
    if (i < corners_.size()) {
        for (const dvec3& corner : corners_[i]) size = std::max(size, largest(corner));
    } else if ((i -= corners_.size()) < scene_.spheres.size()) {
        const Sphere& sphere = scene_.spheres[i];
        size = std::max(size, largest(to_dvec3(sphere.center)) + sphere.radius);
    }
    return {surface.position, direction, hit.primitive, 1e-9 * size};
}

dvec3 Tracer::visibility(const dvec3& origin, const dvec3& direction, double distance) const {
    return visibility(Ray{origin, direction}, distance);
}

dvec3 Tracer::visibility(const Ray& ray, double distance) const {
    if (scene_.settings.shadows == ShadowMode::none) return dvec3(1);
    const Caster caster(ray.origin, ray.direction);
    const auto between = [&](double t) { return t > ray.clearance && t < distance; };
    dvec3 color(1);
    for (std::uint32_t id = 0; id < scene_.primitive_count() && color != dvec3(0); ++id) {
        const SceneMaterial& material = material_of(id);
        const bool filters = scene_.settings.shadows == ShadowMode::filtered && material.transmission > 0;
        int crossings = 0;
        if (id < corners_.size()) {
            const auto hit = caster.triangle(corners_[id], filters ? Border::crossing : Border::closed);
            crossings = hit && between(hit->t) && id != ray.from;
        } else if (id - corners_.size() < scene_.spheres.size() && id != ray.from) {
            const Sphere& sphere = scene_.spheres[id - corners_.size()];
            const auto ends = caster.sphere(to_dvec3(sphere.center), sphere.radius);
            if (ends) crossings = between(ends->near) + between(ends->far);
        } else {
            crossings = intersect_primitive(ray, id).t < distance;
        }
        const dvec3 filter =
            filters ? static_cast<double>(material.transmission) * dvec3(material.base_color) : dvec3(0);
        for (int i = 0; i < crossings; ++i) color *= filter;
    }
    return color;
}

}  // namespace raymill::reference
