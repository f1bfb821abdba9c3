// What a surface does with light: colours, and the split into secondary rays.
#ifndef RAYMILL_MATERIAL_H
#define RAYMILL_MATERIAL_H

#include "lib/surface.h"

/// Texel (x, y) with both coordinates repeated.
static inline float3 texel(const World* world, Texture texture, int x, int y) {
    const int w = (int)texture.width, h = (int)texture.height;
    const int i = ((x % w) + w) % w, j = ((y % h) + h) % h;
    return load3(world->texels + 3ul * (texture.first + (ulong)j * texture.width + i));
}

/// Bilinear, repeating; v = 0 is the bottom row, texel centres lie at (i + 1/2) / size.
static inline float3 sample_texture(const World* world, uint index, float2 uv) {
    const Texture texture = world->textures[index];
    const float x = fma(uv.x - floor(uv.x), (float)texture.width, -0.5f);
    const float y = fma(1.0f - (uv.y - floor(uv.y)), (float)texture.height, -0.5f);
    const float x0 = floor(x), y0 = floor(y);
    const float fx = x - x0, fy = y - y0;
    const int i = (int)x0, j = (int)y0;
    const float3 top = fma3(fx, texel(world, texture, i + 1, j) - texel(world, texture, i, j), texel(world, texture, i, j));
    const float3 bottom = fma3(fx, texel(world, texture, i + 1, j + 1) - texel(world, texture, i, j + 1),
                               texel(world, texture, i, j + 1));
    return fma3(fy, bottom - top, top);
}

/// Whether p lies in an odd cell. The cells are moved by 1/4096 of their size, so that a surface that lies on the border
/// between two layers of cells does not flicker between them.
static inline bool is_odd_cell(float3 p, float scale) {
    const float3 cell = floor(p / scale + 1.0f / 4096.0f);
    const float sum = cell.x + cell.y + cell.z;
    return sum - 2.0f * floor(sum * 0.5f) != 0.0f;
}

/// k_d at the surface.
static inline float3 diffuse_color(const World* world, global const Material* material, const Surface* s) {
    const bool odd = (material->flags & MATERIAL_CHECKER) && is_odd_cell(s->position, material->checker_scale);
    const float3 color = odd ? load3(material->checker) : load3(material->diffuse);
    if (material->diffuse_texture == NO_INDEX) return color;
    return color * sample_texture(world, material->diffuse_texture, s->uv);
}

/// Unpolarised Fresnel reflectance in [0, 1]; 1 under total internal reflection.
/// cos_i in [0, 1]; eta = n_transmitted / n_incident > 0.
/// Source: Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 9.3.5.
static inline float fresnel_dielectric(float cos_i, float eta) {
    if (eta == 1.0f) return 0.0f;  // no boundary, at grazing angles neither
    const float sin2_t = (1.0f - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1.0f) return 1.0f;
    const float cos_t = sqrt(1.0f - sin2_t);
    const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

static inline float3 reflect(float3 direction, float3 n) { return fma3(-2.0f * dot3(direction, n), n, direction); }

/// Snell: the direction beyond a surface with normal n on the incoming side; false under total internal reflection.
/// eta = n_transmitted / n_incident. The tangential part is scaled, the normal part follows from unit length.
static inline bool refract(float3 direction, float3 n, float eta, float3* refracted) {
    if (eta == 1.0f) {
        *refracted = direction;
        return true;
    }
    const float cosine = dot3(direction, n);
    const float3 tangential = fma3(-cosine, n, direction) / eta;
    const float sin2 = dot3(tangential, tangential);
    if (sin2 >= 1.0f) return false;
    *refracted = unit3(fma3(-sqrt(1.0f - sin2), n, tangential));
    return true;
}

/// How the light that arrives from secondary directions is weighed. A weight of zero needs no ray.
typedef struct {
    float reflection, transmission;
    float3 reflected, refracted;  // unit
} Split;

static inline Split split_ray(global const Material* material, const Surface* s, float3 direction) {
    Split split;
    split.reflection = material->reflection;
    split.transmission = material->transmission;
    split.reflected = (float3)(0.0f);
    split.refracted = (float3)(0.0f);
    const bool fresnel = (material->flags & MATERIAL_FRESNEL) != 0;
    const float eta = s->inside ? material->exterior_ior / material->ior : material->ior / material->exterior_ior;
    float3 n = s->shading_normal;
    if (split.transmission > 0.0f || fresnel) {
        bool passes = refract(direction, n, eta, &split.refracted);
        if (passes && dot3(split.refracted, s->geometric_normal) >= 0.0f) {
            n = s->geometric_normal;  // the smooth normal would keep the ray on this side
            passes = refract(direction, n, eta, &split.refracted);
        }
        if (fresnel) {
            const float total = split.reflection + split.transmission;
            const float f = fresnel_dielectric(clamp(-dot3(direction, n), 0.0f, 1.0f), eta);
            split.reflection = total * f;
            split.transmission = total - split.reflection;
        }
        if (!passes) {
            split.reflection += split.transmission;
            split.transmission = 0.0f;
        }
    }
    if (split.reflection > 0.0f) {
        split.reflected = unit3(reflect(direction, s->shading_normal));
        if (dot3(split.reflected, s->geometric_normal) <= 0.0f)
            split.reflected = unit3(reflect(direction, s->geometric_normal));
    }
    return split;
}

/// Throughput that is left when the ray arrives: a segment that ends on the inside ran through the medium.
static inline float3 absorbed(global const Material* material, const Surface* s, float3 throughput, float t) {
    if (!s->inside || !(material->flags & MATERIAL_ABSORBING)) return throughput;
    return throughput * exp_minus(load3(material->absorption) * t);
}

#endif
