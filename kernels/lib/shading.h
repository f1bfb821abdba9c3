// A hit as its light sees it: what all light samples share, and the terms that need no light sample.
#ifndef RAYMILL_SHADING_H
#define RAYMILL_SHADING_H

#include "lib/material.h"

/// Everything about a hit that its light samples share.
typedef struct {
    global const Ray* ray;
    global const Material* material;
    Surface surface;
    float3 to_eye;      // unit
    float3 throughput;  // at the hit, absorption included
    float3 diffuse;     // k_d
    float3 weight;      // of the diffuse and specular terms
    float local_share;  // share of local illumination in the blend
} Shading;

static inline Shading shading_at(const World* world, global const Ray* ray, Hit hit) {
    Shading s;
    const float3 direction = load3(ray->direction);
    s.ray = ray;
    s.surface = surface_at(world, load3(ray->origin), direction, hit);
    s.material = world->materials + s.surface.material;
    s.to_eye = -direction;
    s.throughput = absorbed(s.material, &s.surface, load3(ray->throughput), hit.t);
    s.diffuse = diffuse_color(world, s.material, &s.surface);
    s.local_share = fmax(1.0f - s.material->reflection - s.material->transmission, 0.0f);
    s.weight = s.throughput * s.local_share;
    return s;
}

/// Whether any light could add anything: a perfect mirror's own colour is not seen.
static inline bool answers_light(const Shading* s) {
    return any(s->weight * (s->diffuse + load3(s->material->specular)) != 0.0f);
}

/// The ambient term, weighted by the blend and by the ray.
static inline float3 ambient_radiance(const World* world, const Shading* s) {
    return s->throughput * (load3(s->material->ambient) * constant3(world->constants->ambient) * s->local_share);
}

/// What the surface emits towards the ray, weighted by the ray alone. The back of a one-sided emitter is dark.
static inline float3 emitted_radiance(const Shading* s) {
    if (s->surface.inside && (s->material->flags & MATERIAL_ONE_SIDED)) return (float3)(0.0f);
    return s->throughput * load3(s->material->emission);
}

#endif
