// The lecture's local illumination at a hit, up to the question whether the light is visible.
#ifndef RAYMILL_SHADING_H
#define RAYMILL_SHADING_H

#include "lib/light.h"
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

/// Diffuse and specular answers, colours included, to one light sample.
typedef struct {
    float3 diffuse, specular;
} Answer;

static inline Answer phong_answer(const Shading* s, LightSample light) {
    const float2 terms = phong_terms(s->material, s->surface.shading_normal, light.direction, s->to_eye);
    const Answer a = {s->diffuse * light.incoming * terms.x, load3(s->material->specular) * light.incoming * terms.y};
    return a;
}

/// Gouraud: Phong's formula at the three vertices with their normals, the results interpolated.
/// An area light's I_in is that at the hit; other lights are attenuated at each vertex.
static inline Answer gouraud_answer(const World* world, const Shading* s, global const LightRecord* light,
                                    LightSample sample, float3 light_position) {
    global const Triangle* triangle = world->triangles + s->surface.triangle;
    const float3 origin = load3(s->ray->origin);
    const float side = s->surface.inside ? -1.0f : 1.0f;
    const bool smooth = has_normals(world, triangle);
    const float weights[3] = {s->surface.weights.x, s->surface.weights.y, s->surface.weights.z};
    float3 diffuse_light = (float3)(0.0f), specular_light = (float3)(0.0f);
    for (uint corner = 0; corner < 3; ++corner) {
        global const Vertex* vertex = world->vertices + triangle->vertex[corner];
        const float3 p = load3(vertex->position);
        const float3 normal = load3(vertex->normal);
        const float3 n = smooth ? unit3(normal) * side : s->surface.geometric_normal;
        LightSample at_vertex = sample;
        if (light->type == LIGHT_POINT || light->type == LIGHT_SPOT)
            at_vertex = from_position(light, light_position, p);
        else if (light->type != LIGHT_DIRECTIONAL)
            at_vertex.direction = unit3(light_position - p);
        const float3 to_eye = any(origin != p) ? unit3(origin - p) : s->to_eye;
        const float2 terms = phong_terms(s->material, n, at_vertex.direction, to_eye);
        if (terms.x == 0.0f) continue;  // I_in is not a number where the light lies on the vertex
        diffuse_light = fma3(weights[corner] * terms.x, at_vertex.incoming, diffuse_light);
        specular_light = fma3(weights[corner] * terms.y, at_vertex.incoming, specular_light);
    }
    const Answer a = {s->diffuse * diffuse_light, load3(s->material->specular) * specular_light};
    return a;
}

/// The segment from the hit to the light sample. Where the surface is smooth it starts above the triangle.
static inline void aim_shadow_ray(const World* world, const Shading* s, global const LightRecord* light,
                                  LightSample sample, float3 light_position, global ShadowRay* out) {
    float3 origin = leave_surface(world, &s->surface, 1.0f);
    if (s->surface.smooth && world->constants->robust_offset) {
        origin += smooth_lift(world, &s->surface);
        if (light->type != LIGHT_DIRECTIONAL) {
            const float3 to_light = light_position - origin;
            sample.distance = length3(to_light);
            sample.direction = to_light / sample.distance;
        }
    }
    store3(out->origin, origin);
    store3(out->direction, sample.direction);
    out->t_max = sample.distance * LIGHT_REACH;
}

/// Writes the shadow ray of one light sample and returns 1; returns 0 if the sample cannot add anything.
static inline uint shade_light_sample(const World* world, const Shading* s, global const LightRecord* light,
                                      LightSlot slot, global ShadowRay* out) {
    float3 light_position;
    const LightSample sample = sample_light(light, slot.light, slot.sample, s->surface.position, s->ray->sample,
                                            s->ray->path, &light_position);
    // Below the geometric surface there is no light. Of a smooth mesh that surface is the curved one, and its shadow rays
    // find out; without shadows the guard stays.
    const bool guarded = !s->surface.smooth || world->constants->shadows == SHADOWS_NONE;
    if (guarded && !(dot3(sample.direction, s->surface.geometric_normal) > 0.0f)) return 0;
    const bool gouraud = (s->material->flags & MATERIAL_GOURAUD) && s->surface.triangle != NO_INDEX;
    const Answer answer =
        gouraud ? gouraud_answer(world, s, light, sample, light_position) : phong_answer(s, sample);
    const float3 diffuse = s->weight * answer.diffuse, specular = s->weight * answer.specular;
    if (!any(diffuse != 0.0f) && !any(specular != 0.0f)) return 0;

    aim_shadow_ray(world, s, light, sample, light_position, out);
    out->pixel = s->ray->pixel;
    out->route = s->ray->route;
    out->light = slot.light;
    store3(out->diffuse, diffuse);
    store3(out->specular, specular);
    return 1;
}

#endif
