// Light samples: where each light is met, and what it gives to a point.
#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <type_traits>

#include "lib/random.h"
#include "reference/formulas.hpp"
#include "reference/reference.hpp"

namespace raymill::reference {

namespace {

constexpr double pi = glm::pi<double>();
/// A shadow segment to a light ends this share before it, so as not to meet the surface of the lamp.
constexpr double light_gap = 1e-4;

/// Direction and distance from p to q, dark as yet. At distance zero there is no direction.
LightSample towards(const dvec3& q, const dvec3& p) {
    LightSample s;
    s.distance = glm::length(q - p);
    s.shadow_distance = s.distance * (1 - light_gap);
    if (s.distance > 0) s.direction = (q - p) / s.distance;
    return s;
}

LightSample point_seen(const PointLight& light, const dvec3& q, const dvec3& p) {
    LightSample s = towards(q, p);
    if (s.distance > 0) s.incoming = dvec3(light.intensity) * attenuation(light.attenuation, s.distance);
    return s;
}

LightSample seen(const PointLight& light, const dvec2& ab, const dvec3& p) {
    const dvec3 offset = light.radius > 0 ? static_cast<double>(light.radius) * uniform_sphere(ab) : dvec3(0);
    return point_seen(light, dvec3(light.position) + offset, p);
}

LightSample spot_seen(const SpotLight& light, const dvec3& p) {
    LightSample s = towards(light.position, p);
    if (s.distance == 0) return s;
    const double cos_angle = -glm::dot(s.direction, glm::normalize(dvec3(light.direction)));
    s.incoming = dvec3(light.intensity) * attenuation(light.attenuation, s.distance) *
                 spot_factor(cos_angle, light.inner_angle, light.outer_angle);
    return s;
}

LightSample seen(const SpotLight& light, const dvec2&, const dvec3& p) {
    return spot_seen(light, p);
}

LightSample seen(const DirectionalLight& light, const dvec2&, const dvec3&) {
    LightSample s;
    s.direction = -glm::normalize(dvec3(light.direction));
    s.incoming = light.intensity;
    return s;
}

/// The sample q of a flat light: L cos(theta) area / (pi d^2), dark behind.
LightSample flat_area_seen(const dvec3& q, const dvec3& normal, double area, const dvec3& radiance, const dvec3& p) {
    LightSample s = towards(q, p);
    const double cos_light = -glm::dot(normal, s.direction);
    if (cos_light > 0) s.incoming = radiance * (cos_light * area / (pi * s.distance * s.distance));
    return s;
}

LightSample seen(const RectangleLight& light, const dvec2& ab, const dvec3& p) {
    const dvec3 u = light.edge_u;
    const dvec3 v = light.edge_v;
    const dvec3 normal = glm::cross(u, v);
    const double area = glm::length(normal);
    const dvec3 q = dvec3(light.center) + (ab.x - 0.5) * u + (ab.y - 0.5) * v;
    return flat_area_seen(q, normal / area, area, light.radiance, p);
}

LightSample seen(const DiskLight& light, const dvec2& ab, const dvec3& p) {
    const dvec3 normal = glm::normalize(dvec3(light.normal));
    const Tangents frame = tangents(normal);
    const double radius = light.radius;
    const dvec2 disk = concentric_disk(ab);
    const dvec3 q = dvec3(light.center) + radius * (disk.x * frame.t + disk.y * frame.u);
    return flat_area_seen(q, normal, pi * radius * radius, light.radiance, p);
}

/// Uniform over the solid angle of the visible cap; Pharr, Jakob, Humphreys, PBR 4e, section 6.2.4.
LightSample seen(const SphereLight& light, const dvec2& ab, const dvec3& p) {
    const double radius = light.radius;
    const LightSample axis = towards(light.center, p);
    if (axis.distance <= radius) return {};
    const double sin2_max = radius * radius / (axis.distance * axis.distance);
    const double one_minus_cos_max = sin2_max / (1 + std::sqrt(1 - sin2_max));  // without cancelling for far spheres
    const double one_minus_cos = ab.x * one_minus_cos_max;
    const double cosine = 1 - one_minus_cos;
    const double sin2 = one_minus_cos * (1 + cosine);
    const double azimuth = 2 * pi * ab.y;
    const Tangents frame = tangents(axis.direction);
    LightSample s;
    s.direction = glm::normalize(std::sqrt(sin2) * (std::cos(azimuth) * frame.t + std::sin(azimuth) * frame.u) +
                                 cosine * axis.direction);
    const double half_chord2 = radius * radius - axis.distance * axis.distance * sin2;
    s.distance = axis.distance * cosine - std::sqrt(std::max(0.0, half_chord2));
    s.shadow_distance = s.distance * (1 - light_gap);
    s.incoming = dvec3(light.radiance) * (2 * one_minus_cos_max);
    return s;
}

LightSample seen(const AmbientLight&, const dvec2&, const dvec3&) {
    return {};
}
LightSample seen(const EnvironmentLight&, const dvec2&, const dvec3&) {
    return {};
}

}  // namespace

LightSample Tracer::sample_light(std::uint32_t light, std::uint32_t light_sample, const dvec3& p, std::uint32_t sample,
                                 std::uint32_t path) const {
    const SceneLight& source = scene_.lights[light];
    const dvec2 ab =
        stratified_square(sample * source.samples + light_sample, random_key(path, RANDOM_LIGHT + light));
    LightSample s = std::visit([&](const auto& l) { return seen(l, ab, p); }, source.light);
    s.incoming /= source.samples;
    return s;
}

LightSample Tracer::light_at_vertex(std::uint32_t light, const LightSample& at_hit, const dvec3& p,
                                    const dvec3& vertex) const {
    const SceneLight& source = scene_.lights[light];
    if (std::holds_alternative<DirectionalLight>(source.light)) return at_hit;
    const dvec3 q = p + at_hit.distance * at_hit.direction;
    LightSample s;
    if (const auto* point = std::get_if<PointLight>(&source.light)) {
        s = point_seen(*point, q, vertex);
        s.incoming /= source.samples;
    } else if (const auto* spot = std::get_if<SpotLight>(&source.light)) {
        s = spot_seen(*spot, vertex);
        s.incoming /= source.samples;
    } else {
        s = towards(q, vertex);
        s.incoming = at_hit.incoming;
    }
    return s;
}

}  // namespace raymill::reference
