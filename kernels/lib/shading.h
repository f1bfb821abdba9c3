// Hits as their light sees them: what all light samples share, and the terms that need no light sample.
#ifndef RAYMILL_SHADING_H
#define RAYMILL_SHADING_H

#include "lib/material.h"

/// Everything about sixteen hits that their light samples share.
typedef struct {
    HitLanes hits;
    SurfaceLanes surface;
    uint16 flags;       // of the materials
    Lanes3 to_eye;      // unit
    Lanes3 throughput;  // at the hit, absorption included
    Lanes3 ambient;     // k_a
    Lanes3 diffuse;     // k_d
    Lanes3 specular;    // k_s
    float16 shininess;
    float16 local_share;  // share of local illumination in the blend
    Lanes3 weight;        // of the diffuse and specular terms
    uint passing;         // lanes whose surface passes light on, as bits
} Shading;

COMPILED_ONCE static void shade_hits(const World* world, Shading* s) {
    surfaces_at(world, &s->hits, &s->surface);
    global const Material* first = world->materials;
    const Lanes4 ambient = material4(world, &s->surface, first->ambient);
    const Lanes4 diffuse = material4(world, &s->surface, first->diffuse);
    const Lanes4 specular = material4(world, &s->surface, first->specular);
    s->flags = material_flags(world, &s->surface);
    s->to_eye = lanes_minus(s->hits.direction);
    s->throughput = absorbed(world, &s->surface, s->flags, s->hits.throughput, s->hits.t);
    s->ambient = lanes_xyz(ambient);
    s->shininess = ambient.w;
    s->diffuse = diffuse_color(world, &s->surface, s->flags, lanes_xyz(diffuse));
    s->specular = lanes_xyz(specular);
    s->local_share = positive16(1.0f - diffuse.w - specular.w);  // reflection and transmission
    s->passing = lane_mask16(diffuse.w + specular.w > 0.0f) & first_lanes(s->hits.count);
    s->weight = lanes_scale(s->throughput, s->local_share);
}

/// Whether any light could add anything: a perfect mirror's own colour is not seen.
static inline bool answers_light(const Shading* s) {
    return any16(lanes_any(lanes_mul(s->weight, lanes_add(s->diffuse, s->specular))));
}

/// The ambient term, weighted by the blend and by the ray.
static inline Lanes3 ambient_radiance(const World* world, const Shading* s) {
    const Lanes3 light = lanes_of(constant3(world->constants->ambient));
    return lanes_mul(s->throughput, lanes_scale(lanes_mul(s->ambient, light), s->local_share));
}

/// What the surfaces emit towards the rays, weighted by the rays alone. The back of a one-sided emitter is dark.
static inline Lanes3 emitted_radiance(const World* world, const Shading* s) {
    const int16 dark = s->surface.inside & ((s->flags & MATERIAL_ONE_SIDED) != 0);
    const Lanes3 emission = lanes_xyz(material4(world, &s->surface, world->materials->emission));
    return lanes_select(lanes_mul(s->throughput, emission), lanes_of((float3)(0.0f)), dark);
}

#endif
