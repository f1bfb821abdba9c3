// What a light sample gives to a point: direction, distance, and I_in, without visibility.
#pragma once

#include "frames/sampling.hpp"

namespace raymill::bench {

struct LightPoint {
    vec3 position{0};  // for shading at other points (Gouraud)
    vec3 direction{0, 1, 0};
    float distance = 0;
    vec3 incoming{0};  // over the light's number of samples
};

/// Point and spot lights, seen from p. The position is known.
inline void shine_from_position(const LightRecord& light, const vec3& p, LightPoint& s) {
    const vec3 to_light = s.position - p;
    s.distance = glm::length(to_light);
    s.direction = to_light / s.distance;
    const float d = s.distance;
    const float attenuation = light.attenuation[0] + d * (light.attenuation[1] + d * light.attenuation[2]);
    s.incoming = vec(light.intensity) / (attenuation * static_cast<float>(light.samples));
    if (light.type != LIGHT_SPOT) return;
    const float cosine = -glm::dot(s.direction, vec(light.normal));
    const float cone = std::clamp(cosine * light.cone_scale + light.cone_offset, 0.0f, 1.0f);
    s.incoming *= cone * cone;
}

/// A flat area light: I_in = L cos dA / (pi d^2).
inline void shine_from_area(const LightRecord& light, const vec3& p, LightPoint& s) {
    const vec3 to_light = s.position - p;
    s.distance = glm::length(to_light);
    s.direction = to_light / s.distance;
    const float cosine = std::max(-glm::dot(s.direction, vec(light.normal)), 0.0f);
    s.incoming = vec(light.intensity) *
                 (cosine * light.area / (PI * s.distance * s.distance * static_cast<float>(light.samples)));
}

/// A sphere light by its visible cap: I_in = L * solid angle / pi.
inline LightPoint shine_from_sphere(const LightRecord& light, const vec3& p, const vec2& square) {
    LightPoint s;
    const vec3 to_center = vec(light.position) - p;
    const float d2 = glm::dot(to_center, to_center), r2 = light.radius * light.radius;
    if (!(d2 > r2)) return s;
    const float sin2_max = r2 / d2;
    const float cap = sin2_max / (1 + std::sqrt(std::max(1 - sin2_max, 0.0f)));
    const float below = square.x * cap, cosine = 1 - below, sin2 = below * (2 - below);
    const float d = std::sqrt(d2), angle = 2 * PI * square.y;
    const vec3 axis = to_center / d;
    const auto [t, u] = tangents(axis);
    s.direction = glm::normalize(std::sqrt(sin2) * (std::cos(angle) * t + std::sin(angle) * u) + cosine * axis);
    s.distance = d * cosine - std::sqrt(std::max(r2 - d2 * sin2, 0.0f));
    s.position = p + s.distance * s.direction;
    s.incoming = vec(light.intensity) * (2 * cap / static_cast<float>(light.samples));
    return s;
}

/// The point of the light that the sample picks.
inline vec3 point_of_light(const LightRecord& light, const vec2& square) {
    const vec3 position = vec(light.position);
    if (light.type == LIGHT_RECTANGLE)
        return position + (square.x - 0.5f) * vec(light.axis_u) + (square.y - 0.5f) * vec(light.axis_v);
    if (light.type == LIGHT_DISK) {
        const vec2 disk = concentric_disk(square);
        return position + disk.x * vec(light.axis_u) + disk.y * vec(light.axis_v);
    }
    if (light.radius == 0) return position;
    const float z = 1 - 2 * square.x, angle = 2 * PI * square.y;
    const float r = std::sqrt(std::max(1 - z * z, 0.0f));
    return position + light.radius * vec3(r * std::cos(angle), r * std::sin(angle), z);
}

inline LightPoint sample_light(const LightRecord& light, const LightSlot& slot, const vec3& p, const PathRay& ray) {
    LightPoint s;
    if (light.type == LIGHT_DIRECTIONAL) {
        s.direction = -vec(light.normal);
        s.distance = INFINITY;
        s.incoming = vec(light.intensity) / static_cast<float>(light.samples);
        return s;
    }
    vec2 square(0.5f);
    if (light.type >= LIGHT_RECTANGLE || light.radius > 0)
        square = stratified_sample(ray.sample * light.samples + slot.sample, ray.path, RANDOM_LIGHT + slot.light);
    if (light.type == LIGHT_SPHERE) return shine_from_sphere(light, p, square);
    s.position = point_of_light(light, square);
    if (light.type == LIGHT_RECTANGLE || light.type == LIGHT_DISK)
        shine_from_area(light, p, s);
    else
        shine_from_position(light, p, s);
    return s;
}

}  // namespace raymill::bench
