#include "ray_sets.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "mesh_parts.hpp"

namespace raymill::bench {

namespace {

glm::dvec3 position(const Scene& scene, std::uint32_t vertex) {
    const float(&p)[3] = scene.vertices[vertex].position;
    return {p[0], p[1], p[2]};
}

/// A point of a surface, lifted off it to either side, and the normal on the side that the ray came from.
struct Lifted {
    glm::dvec3 point;  // on that side
    glm::dvec3 behind;
    glm::dvec3 normal;
};

Lifted surface_at(const Scene& scene, const BenchRay& ray, const CameraHit& hit) {
    const glm::dvec3 direction(ray.direction);
    glm::dvec3 point, normal;
    if (hit.primitive < scene.triangles.size()) {
        const auto& corner = scene.triangles[hit.primitive].vertex;
        const glm::dvec3 a = position(scene, corner[0]), b = position(scene, corner[1]), c = position(scene, corner[2]);
        normal = glm::normalize(glm::cross(b - a, c - a));
        point = a + double{hit.u} * (b - a) + double{hit.v} * (c - a);
    } else {
        const Sphere& sphere = scene.spheres[hit.primitive - scene.triangles.size()];
        const glm::dvec3 center(sphere.center[0], sphere.center[1], sphere.center[2]);
        normal = glm::normalize(glm::dvec3(ray.origin) + double{hit.t} * direction - center);
        point = center + double{sphere.radius} * normal;
    }
    if (glm::dot(normal, direction) > 0) normal = -normal;
    const double far = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z), double{hit.t}});
    const glm::dvec3 lift = 0x1p-16 * far * normal;
    return {point + lift, point - lift, normal};
}

/// Two unit vectors square to a unit one and each other.
std::pair<glm::dvec3, glm::dvec3> tangents(const glm::dvec3& normal) {
    const glm::dvec3 other = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(normal, other));
    return {u, glm::cross(normal, u)};
}

glm::dvec3 cosine_direction(const glm::dvec3& normal, Random& random) {
    const double r2 = random.uniform(), angle = 2 * glm::pi<double>() * random.uniform();
    const auto [u, v] = tangents(normal);
    return glm::normalize(std::sqrt(r2) * (std::cos(angle) * u + std::sin(angle) * v) + std::sqrt(1 - r2) * normal);
}

/// Snell's law on entering from air: the tangential part is scaled, the normal part follows from unit length.
glm::dvec3 refracted_direction(const glm::dvec3& in, const glm::dvec3& normal) {
    const glm::dvec3 tangential = (in - glm::dot(in, normal) * normal) / GLASS_INDEX;
    return glm::normalize(tangential - std::sqrt(1 - glm::dot(tangential, tangential)) * normal);
}

/// Nothing where the target lies behind the surface: no renderer would send that ray.
std::optional<BenchRay> shadow_ray(const Lifted& from, const glm::dvec3& target) {
    const glm::vec3 origin(from.point);
    const glm::dvec3 way = target - glm::dvec3(origin);
    const double distance = glm::length(way);
    if (!(glm::dot(from.normal, way) > 0)) return {};
    return BenchRay{origin, static_cast<float>(distance), glm::vec3(way / distance)};
}

}  // namespace

RaySet camera_rays(const Camera& camera, int width, int height) {
    assert(width % TILE == 0 && height % TILE == 0);
    const glm::dvec3 forward = glm::normalize(camera.look_at - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const glm::dvec3 up = glm::cross(right, forward);
    const double half = std::tan(glm::radians(camera.fov) / 2), aspect = static_cast<double>(width) / height;
    RaySet set{"P", "camera rays", false, {}, {}};
    for (int tile = 0; tile < width / TILE * (height / TILE); ++tile)
        for (int i = 0; i < TILE * TILE; ++i) {
            const int in_x = (i & 1) | (i >> 1 & 2) | (i >> 2 & 4), in_y = (i >> 1 & 1) | (i >> 2 & 2) | (i >> 3 & 4);
            const int x = tile % (width / TILE) * TILE + in_x, y = tile / (width / TILE) * TILE + in_y;
            const double sx = (2 * (x + 0.5) / width - 1) * half * aspect, sy = (1 - 2 * (y + 0.5) / height) * half;
            const glm::dvec3 direction = glm::normalize(forward + sx * right + sy * up);
            set.rays.push_back({glm::vec3(camera.eye), INFINITY, glm::vec3(direction)});
        }
    return set;
}

std::vector<RaySet> bounced_rays(const BenchScene& bench, const RaySet& camera, std::span<const CameraHit> hits) {
    std::vector<RaySet> sets = {{"S", "shadow rays to a point", true, {}, {}},
                                {"A", "shadow rays to an area", true, {}, {}},
                                {"R", "mirrored rays", false, {}, {}},
                                {"T", "rays through glass", false, {}, {}},
                                {"D", "diffuse bounces", false, {}, {}}};
    RaySet &to_point = sets[0], &to_area = sets[1], &mirrored = sets[2], &through = sets[3], &diffuse = sets[4];
    const auto [side_u, side_v] = tangents(glm::dvec3(bench.lamp.axis));
    Random on_lamp(5), on_hemisphere(6);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (i % CHUNK == 0) {
            to_point.segments.push_back(0);
            to_area.segments.push_back(0);
        }
        if (hits[i].primitive == NO_INDEX) continue;
        const glm::dvec3 in(camera.rays[i].direction);
        const Lifted at = surface_at(bench.scene, camera.rays[i], hits[i]);
        const auto add_shadow = [&](RaySet& set, const glm::dvec3& target) {
            if (const auto ray = shadow_ray(at, target)) {
                set.rays.push_back(*ray);
                ++set.segments.back();
            }
        };
        const glm::dvec3 lamp(bench.lamp.position);
        add_shadow(to_point, lamp);
        const double edge = bench.lamp.edge, s = on_lamp.uniform() - 0.5, t = on_lamp.uniform() - 0.5;
        const glm::dvec3 on_area = lamp + edge * (s * side_u + t * side_v);
        if (glm::dot(glm::dvec3(bench.lamp.axis), at.point - on_area) > 0) add_shadow(to_area, on_area);
        const glm::dvec3 out = in - 2 * glm::dot(in, at.normal) * at.normal;
        mirrored.rays.push_back({glm::vec3(at.point), INFINITY, glm::vec3(glm::normalize(out))});
        through.rays.push_back({glm::vec3(at.behind), INFINITY, glm::vec3(refracted_direction(in, at.normal))});
        diffuse.rays.push_back({glm::vec3(at.point), INFINITY, glm::vec3(cosine_direction(at.normal, on_hemisphere))});
    }
    return sets;
}

}  // namespace raymill::bench
