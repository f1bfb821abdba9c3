// What surfaces do with light: colours, and the split into secondary rays, for sixteen hits at a time.
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
    const float3 top =
        fma3(fx, texel(world, texture, i + 1, j) - texel(world, texture, i, j), texel(world, texture, i, j));
    const float3 bottom = fma3(fx, texel(world, texture, i + 1, j + 1) - texel(world, texture, i, j + 1),
                               texel(world, texture, i, j + 1));
    return fma3(fy, bottom - top, top);
}

/// Lanes that lie in an odd cell. The cells are moved by 1/4096 of their size, so that a surface that lies on the
/// border between two layers of cells does not flicker between them.
static inline int16 in_odd_cell(Lanes3 p, float16 scale) {
    const float16 sum =
        floor(p.x / scale + 1.0f / 4096.0f) + floor(p.y / scale + 1.0f / 4096.0f) + floor(p.z / scale + 1.0f / 4096.0f);
    return sum - 2.0f * floor(sum * 0.5f) != 0.0f;
}

/// color times that of the lanes' textures, where they have one.
static inline Lanes3 textured(const World* world, const SurfaceLanes* s, uint16 texture, Lanes3 color) {
    if (!any16(texture != NO_INDEX)) return color;
    float texels[3][LANES];
    for (uint lane = 0; lane < LANES; ++lane) {
        const uint index = ((const uint*)&texture)[lane];
        float3 t = (float3)(1.0f);
        if (index != NO_INDEX)
            t = sample_texture(world, index,
                               (float2)(((const float*)&s->uv[0])[lane], ((const float*)&s->uv[1])[lane]));
        texels[0][lane] = t.x;
        texels[1][lane] = t.y;
        texels[2][lane] = t.z;
    }
    const Lanes3 t = {vload16(0, texels[0]), vload16(0, texels[1]), vload16(0, texels[2])};
    return lanes_mul(color, t);
}

/// k_d at the surfaces.
static inline Lanes3 diffuse_color(const World* world, const SurfaceLanes* s, uint16 flags, Lanes3 diffuse) {
    global const Material* first = world->materials;
    const Lanes4 checker = material4(world, s, first->checker);
    const int16 checkered = (flags & MATERIAL_CHECKER) != 0;
    Lanes3 color = diffuse;
    if (any16(checkered)) {
        const float16 scale = material4(world, s, first->absorption).w;
        color = lanes_select(color, lanes_xyz(checker), checkered & in_odd_cell(s->position, scale));
    }
    return textured(world, s, as_uint16(checker.w), color);
}

/// Unpolarised Fresnel reflectance in [0, 1]; 1 under total internal reflection.
/// cos_i in [0, 1]; eta = n_transmitted / n_incident > 0.
/// Source: Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 9.3.5.
static inline float16 fresnel_dielectric(float16 cos_i, float16 eta) {
    const float16 sin2_t = (1.0f - cos_i * cos_i) / (eta * eta);
    const float16 cos_t = sqrt(positive16(1.0f - sin2_t));
    const float16 parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const float16 perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const float16 reflectance = 0.5f * (parallel * parallel + perpendicular * perpendicular);
    const float16 total = select(reflectance, (float16)(1.0f), sin2_t >= 1.0f);
    return select(total, (float16)(0.0f), eta == 1.0f);  // no boundary, at grazing angles neither
}

static inline Lanes3 reflect(Lanes3 direction, Lanes3 n) {
    return lanes_fma(-2.0f * lanes_dot(direction, n), n, direction);
}

/// Snell: directions beyond surfaces with normal n on the incoming side; returns the lanes that pass, not those under
/// total internal reflection. eta = n_transmitted / n_incident. The tangential part is scaled, the normal part follows
/// from unit length.
static inline int16 refract(Lanes3 direction, Lanes3 n, float16 eta, Lanes3* refracted) {
    const float16 cosine = lanes_dot(direction, n);
    const Lanes3 tangential = lanes_div(lanes_fma(-cosine, n, direction), eta);
    const float16 sin2 = lanes_dot(tangential, tangential);
    const int16 no_boundary = eta == 1.0f;
    const Lanes3 bent = lanes_unit(lanes_fma(-sqrt(positive16(1.0f - sin2)), n, tangential));
    *refracted = lanes_select(bent, direction, no_boundary);
    return no_boundary | (sin2 < 1.0f);
}

/// How the light that arrives from secondary directions is weighed. A weight of zero needs no ray.
typedef struct {
    float16 reflection, transmission;
    Lanes3 reflected, refracted;  // unit
} Split;

/// Refracted directions, and which rays pass.
static inline int16 refract_at(const SurfaceLanes* s, Lanes3 direction, float16 eta, Lanes3* n, Lanes3* refracted) {
    *n = s->shading_normal;
    const int16 passes = refract(direction, *n, eta, refracted);
    const int16 stays = passes & (lanes_dot(*refracted, s->geometric_normal) >= 0.0f);
    if (!any16(stays)) return passes;
    // The smooth normal would keep the ray on this side.
    *n = lanes_select(*n, s->geometric_normal, stays);
    Lanes3 flat;
    const int16 flat_passes = refract(direction, s->geometric_normal, eta, &flat);
    *refracted = lanes_select(*refracted, flat, stays);
    return select(passes, flat_passes, stays);
}

static inline Lanes3 reflect_at(const SurfaceLanes* s, Lanes3 direction) {
    const Lanes3 reflected = lanes_unit(reflect(direction, s->shading_normal));
    const int16 enters = lanes_dot(reflected, s->geometric_normal) <= 0.0f;
    if (!any16(enters)) return reflected;
    return lanes_select(reflected, lanes_unit(reflect(direction, s->geometric_normal)), enters);
}

static inline Split split_rays(const World* world, const SurfaceLanes* s, Lanes3 direction) {
    global const Material* first = world->materials;
    Split split;
    split.reflection = material4(world, s, first->diffuse).w;
    split.transmission = material4(world, s, first->specular).w;
    const int16 fresnel = (material_flags(world, s) & MATERIAL_FRESNEL) != 0;
    const int16 bends = (split.transmission > 0.0f) | fresnel;
    if (any16(bends)) {
        const float16 ior = material4(world, s, first->emission).w, outside = material4(world, s, first->base_color).w;
        const float16 eta = select(ior, outside, s->inside) / select(outside, ior, s->inside);
        Lanes3 n;
        const int16 passes = refract_at(s, direction, eta, &n, &split.refracted);
        const float16 cosine = positive16(-lanes_dot(direction, n));
        const float16 f = fresnel_dielectric(min16(cosine, (float16)(1.0f)), eta);
        const float16 total = split.reflection + split.transmission, reflected = total * f;
        split.reflection = select(split.reflection, reflected, fresnel);
        split.transmission = select(split.transmission, total - reflected, fresnel);
        const int16 all_back = bends & ~passes;
        split.reflection = select(split.reflection, split.reflection + split.transmission, all_back);
        split.transmission = select(split.transmission, (float16)(0.0f), all_back);
    }
    if (any16(split.reflection > 0.0f)) split.reflected = reflect_at(s, direction);
    return split;
}

/// Throughput that is left when the rays arrive: a segment that ends on the inside ran through the medium.
static inline Lanes3 absorbed(const World* world, const SurfaceLanes* s, uint16 flags, Lanes3 throughput, float16 t) {
    const int16 absorbs = s->inside & ((flags & MATERIAL_ABSORBING) != 0);
    if (!any16(absorbs)) return throughput;
    const Lanes4 absorption = material4(world, s, world->materials->absorption);
    const Lanes3 left = {lanes_exp_minus(absorption.x * t), lanes_exp_minus(absorption.y * t),
                         lanes_exp_minus(absorption.z * t)};
    return lanes_select(throughput, lanes_mul(throughput, left), absorbs);
}

#endif
