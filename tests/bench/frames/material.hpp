// Colours, the Phong and Blinn terms, and how a surface splits a ray.
#pragma once

#include "frames/sampling.hpp"
#include "frames/surface.hpp"

namespace raymill::bench {

/// Bilinear, repeating; uv (0, 0) is the bottom left corner.
inline vec3 sample_texture(const TextureImage& image, const vec2& uv) {
    const int w = static_cast<int>(image.width), h = static_cast<int>(image.height);
    const float x = (uv.x - std::floor(uv.x)) * static_cast<float>(w) - 0.5f;
    const float y = (1 - (uv.y - std::floor(uv.y))) * static_cast<float>(h) - 0.5f;
    const float x0 = std::floor(x), y0 = std::floor(y);
    const auto texel = [&](int i, int j) {
        return image
            .texels[static_cast<std::size_t>((j + h) % h) * image.width + static_cast<std::size_t>((i + w) % w)];
    };
    const int i = static_cast<int>(x0), j = static_cast<int>(y0);
    return glm::mix(glm::mix(texel(i, j), texel(i + 1, j), x - x0),
                    glm::mix(texel(i, j + 1), texel(i + 1, j + 1), x - x0), y - y0);
}

inline vec3 diffuse_color(const World& world, const SurfacePoint& s) {
    const Material& m = *s.material;
    vec3 color = vec(m.diffuse);
    if (m.flags & MATERIAL_CHECKER) {
        const vec3 cell = glm::floor(s.position / m.checker_scale + 1.0f / 4096);
        const float half = 0.5f * (cell.x + cell.y + cell.z);
        if (half != std::floor(half)) color = vec(m.checker);
    }
    if (m.diffuse_texture == NO_INDEX) return color;
    return color * sample_texture(world.scene.images[m.diffuse_texture], s.uv);
}

/// max(n.l, 0) and the highlight; unit vectors, l towards the light, v towards the eye.
inline vec2 phong_terms(const Material& m, const vec3& n, const vec3& l, const vec3& v) {
    const float cosine = glm::dot(n, l);
    if (!(cosine > 0)) return vec2(0);
    if (m.specular[0] == 0 && m.specular[1] == 0 && m.specular[2] == 0) return {cosine, 0};
    const float highlight =
        m.flags & MATERIAL_BLINN ? glm::dot(n, glm::normalize(l + v)) : glm::dot(v, 2 * cosine * n - l);
    return {cosine, std::pow(std::max(0.0f, highlight), m.shininess)};
}

/// Unpolarised reflectance: Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 9.3.5.
inline float fresnel_dielectric(float cos_i, float eta) {
    if (eta == 1) return 0;
    const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    const float cos_t = std::sqrt(1 - sin2_t);
    const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// Snell; false under total internal reflection. eta = n_transmitted / n_incident.
inline bool refract_at(const vec3& direction, const vec3& n, float eta, vec3& refracted) {
    if (eta == 1) {
        refracted = direction;
        return true;
    }
    const vec3 tangential = (direction - glm::dot(direction, n) * n) / eta;
    const float sin2 = glm::dot(tangential, tangential);
    if (sin2 >= 1) return false;
    refracted = glm::normalize(tangential - std::sqrt(1 - sin2) * n);
    return true;
}

struct RaySplit {
    float reflection = 0, transmission = 0;
    vec3 reflected{0}, refracted{0};  // unit
};

inline RaySplit split_ray(const SurfacePoint& s, const vec3& direction) {
    const Material& m = *s.material;
    RaySplit split{m.reflection, m.transmission, {}, {}};
    const bool fresnel = m.flags & MATERIAL_FRESNEL;
    if (split.transmission > 0 || fresnel) {
        const float eta = s.inside ? m.exterior_ior / m.ior : m.ior / m.exterior_ior;
        vec3 n = s.shading;
        bool passes = refract_at(direction, n, eta, split.refracted);
        if (passes && glm::dot(split.refracted, s.geometric) >= 0) {
            n = s.geometric;
            passes = refract_at(direction, n, eta, split.refracted);
        }
        if (fresnel) {
            const float total = split.reflection + split.transmission;
            split.reflection = total * fresnel_dielectric(std::clamp(-glm::dot(direction, n), 0.0f, 1.0f), eta);
            split.transmission = total - split.reflection;
        }
        if (!passes) {
            split.reflection += split.transmission;
            split.transmission = 0;
        }
    }
    if (split.reflection > 0) {
        split.reflected = glm::normalize(glm::reflect(direction, s.shading));
        if (glm::dot(split.reflected, s.geometric) <= 0)
            split.reflected = glm::normalize(glm::reflect(direction, s.geometric));
    }
    return split;
}

/// What the medium leaves of light over the way t that ended on the inside.
inline vec3 absorption(const SurfacePoint& s, float t) {
    if (!s.inside || !(s.material->flags & MATERIAL_ABSORBING)) return vec3(1);
    return glm::exp(-t * vec(s.material->absorption));
}

/// Radiance from far away: a colour, or a lat-long image with +y on top and +z in the middle.
inline vec3 environment_radiance(const World& world, const vec3& d) {
    const vec3 background = vec(world.constants.background);
    if (world.constants.environment == NO_INDEX) return background;
    const TextureImage& image = world.scene.images[world.constants.environment];
    const int w = static_cast<int>(image.width), h = static_cast<int>(image.height);
    const float x = (0.5f - 0.5f * std::atan2(d.x, d.z) / PI) * static_cast<float>(w) - 0.5f;
    const float y = std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y) / PI * static_cast<float>(h) - 0.5f;
    const float x0 = std::floor(x), y0 = std::floor(y);
    const auto texel = [&](int i, int j) {
        const auto row = static_cast<std::size_t>(std::clamp(j, 0, h - 1));
        return image.texels[row * image.width + static_cast<std::size_t>((i + w) % w)];
    };
    const int i = static_cast<int>(x0), j = static_cast<int>(y0);
    const vec3 sky = glm::mix(glm::mix(texel(i, j), texel(i + 1, j), x - x0),
                              glm::mix(texel(i, j + 1), texel(i + 1, j + 1), x - x0), y - y0);
    return background + sky * vec(world.constants.environment_scale);
}

}  // namespace raymill::bench
