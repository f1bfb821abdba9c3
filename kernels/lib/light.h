// What a light sample gives to a point: direction, distance, and I_in of the lecture, without visibility.
#ifndef RAYMILL_LIGHT_H
#define RAYMILL_LIGHT_H

#include "lib/sampling.h"

typedef struct {
    float3 direction;  // unit, towards the light
    float distance;    // INFINITY for directional lights
    float3 incoming;   // I_in, divided by the number of samples
} LightSample;

// A shadow ray ends this much of its length before the light, so that a lamp's own surface does not block it.
#define LIGHT_REACH (1.0f - 1e-4f)

static inline float attenuate(global const LightRecord* light, float d) {
    return 1.0f / fma(fma(light->attenuation[2], d, light->attenuation[1]), d, light->attenuation[0]);
}

/// Point and spot lights at `position`, seen from p.
static inline LightSample from_position(global const LightRecord* light, float3 position, float3 p) {
    const float3 to_light = position - p;
    LightSample s;
    s.distance = length3(to_light);
    s.direction = to_light / s.distance;
    s.incoming = load3(light->intensity) * (attenuate(light, s.distance) / (float)light->samples);
    if (light->type == LIGHT_SPOT) {
        const float cosine = -dot3(s.direction, load3(light->normal));
        const float cone = clamp(fma(cosine, light->cone_scale, light->cone_offset), 0.0f, 1.0f);
        s.incoming *= cone * cone;
    }
    return s;
}

/// A flat area light's sample point: I_in = L cos dA / (pi d^2).
static inline LightSample from_area(global const LightRecord* light, float3 position, float3 p) {
    const float3 to_light = position - p;
    LightSample s;
    s.distance = length3(to_light);
    s.direction = to_light / s.distance;
    const float cosine = fmax(-dot3(s.direction, load3(light->normal)), 0.0f);
    const float form = cosine * light->area / (PI * s.distance * s.distance * (float)light->samples);
    s.incoming = load3(light->intensity) * form;
    return s;
}

/// A sphere light by its visible cap: I_in = L * solid angle / pi. Nothing from inside.
static inline LightSample from_sphere(global const LightRecord* light, float3 p, float2 square) {
    const float3 to_center = load3(light->position) - p;
    const float d2 = dot3(to_center, to_center), r2 = light->radius * light->radius;
    LightSample s;
    s.incoming = (float3)(0.0f);
    s.direction = (float3)(0.0f, 1.0f, 0.0f);
    s.distance = 0.0f;
    if (!(d2 > r2)) return s;
    const float sin2_max = r2 / d2;
    // 1 - cos without cancellation.
    const float cap = sin2_max / (1.0f + sqrt(fmax(1.0f - sin2_max, 0.0f)));
    const float below = square.x * cap;  // 1 - cos of the sample
    const float cosine = 1.0f - below;
    const float sin2 = below * (2.0f - below);
    const float2 around = cos_sin_turns(square.y) * sqrt(sin2);
    const float3 axis = to_center / sqrt(d2);
    float3 t, u;
    tangents(axis, &t, &u);
    s.direction = unit3(fma3(around.x, t, fma3(around.y, u, axis * cosine)));
    const float along = sqrt(d2) * cosine;
    s.distance = along - sqrt(fmax(r2 - d2 * sin2, 0.0f));
    s.incoming = load3(light->intensity) * (2.0f * cap / (float)light->samples);
    return s;
}

/// The point of the light that the sample picks: of the ball of a point light, of a rectangle or a disk.
static inline float3 light_point(global const LightRecord* light, float2 square) {
    const float3 position = load3(light->position);
    if (light->type == LIGHT_RECTANGLE)
        return fma3(square.x - 0.5f, load3(light->axis_u), fma3(square.y - 0.5f, load3(light->axis_v), position));
    if (light->type == LIGHT_DISK) {
        const float2 disk = concentric_disk(square);
        return fma3(disk.x, load3(light->axis_u), fma3(disk.y, load3(light->axis_v), position));
    }
    if (light->radius == 0.0f) return position;
    const float z = fma(square.x, -2.0f, 1.0f);
    const float2 around = cos_sin_turns(square.y) * sqrt(fmax(fma(-z, z, 1.0f), 0.0f));
    return fma3(light->radius, (float3)(around.x, around.y, z), position);
}

/// Sample `slot` of the scene's light samples, seen from p on this path of camera sample `sample`.
/// `light_position` receives the sample's point, for shading at other points (Gouraud).
static inline LightSample sample_light(global const LightRecord* light, uint index, uint light_sample, float3 p,
                                       uint sample, uint path, float3* light_position) {
    *light_position = load3(light->position);
    if (light->type == LIGHT_DIRECTIONAL) {
        LightSample s = {-load3(light->normal), INFINITY, load3(light->intensity) / (float)light->samples};
        return s;
    }
    const bool extended = light->type >= LIGHT_RECTANGLE || light->radius > 0.0f;
    float2 square = (float2)(0.5f);
    if (extended)
        square = stratified_sample(sample * light->samples + light_sample, path, RANDOM_LIGHT + index);
    if (light->type == LIGHT_SPHERE) {
        const LightSample s = from_sphere(light, p, square);
        *light_position = fma3(s.distance, s.direction, p);
        return s;
    }
    *light_position = light_point(light, square);
    if (light->type == LIGHT_RECTANGLE || light->type == LIGHT_DISK) return from_area(light, *light_position, p);
    return from_position(light, *light_position, p);
}

#endif
