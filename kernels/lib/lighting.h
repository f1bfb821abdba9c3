// The lecture's local illumination, sixteen hits at a time, up to the question whether the light is visible.
#ifndef RAYMILL_LIGHTING_H
#define RAYMILL_LIGHTING_H

#include "lib/light.h"
#include "lib/shading.h"

/// max(n.l, 0) and the highlight's cosine to the power of the shininess, both 0 where the light is behind the normal.
/// Unit vectors; l towards the light, v towards the eye.
static inline void phong_terms(const Shading* s, Lanes3 n, Lanes3 l, Lanes3 v, float16* diffuse, float16* specular) {
    const float16 cosine = lanes_dot(n, l);
    *diffuse = positive16(cosine);
    *specular = (float16)(0.0f);
    if (!any16(lanes_any(s->specular))) return;
    float16 highlight = lanes_dot(v, lanes_fma(2.0f * cosine, n, lanes_minus(l)));
    const int16 blinn = (s->flags & MATERIAL_BLINN) != 0;
    if (any16(blinn)) {
        const Lanes3 sum = lanes_add(l, v);
        const float16 length = lanes_length(sum);
        const float16 halfway = select((float16)(0.0f), lanes_dot(n, sum) / length, length > 0.0f);
        highlight = select(highlight, halfway, blinn);
    }
    *specular = select((float16)(0.0f), lanes_power(positive16(highlight), s->shininess), cosine > 0.0f);
}

/// Light that the surface gives back of one light sample, with and without direction; colours included.
typedef struct {
    Lanes3 diffuse, specular;
} Answer;

static inline Answer phong_answer(const Shading* s, LightSample light) {
    float16 diffuse, specular;
    phong_terms(s, s->surface.shading_normal, light.direction, s->to_eye, &diffuse, &specular);
    const Answer a = {lanes_scale(lanes_mul(s->diffuse, light.incoming), diffuse),
                      lanes_scale(lanes_mul(s->specular, light.incoming), specular)};
    return a;
}

/// The normal of a triangle's corner, on the side that the ray came from.
static inline Lanes3 corner_normal(const SurfaceLanes* s, uint k) {
    const float16 side = select((float16)(1.0f), (float16)(-1.0f), s->inside);
    const Lanes3 own = lanes_scale(lanes_unit(s->corner[k].normal), side);
    return lanes_select(s->geometric_normal, own, s->has_normals);
}

/// From a triangle's corner to the ray's origin.
static inline Lanes3 corner_to_eye(const Shading* s, uint k) {
    const Lanes3 to_eye = lanes_sub(s->hits.origin, s->surface.corner[k].position);
    return lanes_select(s->to_eye, lanes_unit(to_eye), lanes_any(to_eye));
}

/// Gouraud: Phong's formula at the three vertices with their normals, the results interpolated.
/// An area light's I_in is that at the hit; other lights are attenuated at each vertex.
static inline Answer gouraud_answer(const Shading* s, global const LightRecord* light, LightSample sample,
                                    Lanes3 light_position) {
    Lanes3 diffuse_light = lanes_of((float3)(0.0f)), specular_light = diffuse_light;
    for (uint k = 0; k < 3; ++k) {
        const Lanes3 p = s->surface.corner[k].position;
        LightSample at_vertex = sample;
        if (light->type == LIGHT_POINT || light->type == LIGHT_SPOT)
            at_vertex = from_position(light, light_position, p);
        else if (light->type != LIGHT_DIRECTIONAL)
            at_vertex.direction = towards(light_position, p).direction;
        float16 diffuse, specular;
        phong_terms(s, corner_normal(&s->surface, k), at_vertex.direction, corner_to_eye(s, k), &diffuse, &specular);
        const float16 weight = s->surface.corner[k].weight;
        const int16 lit = diffuse != 0.0f;  // I_in is not a number where the light lies on the vertex
        diffuse_light =
            lanes_select(diffuse_light, lanes_fma(weight * diffuse, at_vertex.incoming, diffuse_light), lit);
        specular_light =
            lanes_select(specular_light, lanes_fma(weight * specular, at_vertex.incoming, specular_light), lit);
    }
    const Answer a = {lanes_mul(s->diffuse, diffuse_light), lanes_mul(s->specular, specular_light)};
    return a;
}

static inline Answer answer(const Shading* s, global const LightRecord* light, LightSample sample,
                            Lanes3 light_position) {
    Answer a = phong_answer(s, sample);
    const int16 gouraud = s->surface.is_triangle & ((s->flags & MATERIAL_GOURAUD) != 0);
    if (any16(gouraud)) {
        const Answer at_corners = gouraud_answer(s, light, sample, light_position);
        a.diffuse = lanes_select(a.diffuse, at_corners.diffuse, gouraud);
        a.specular = lanes_select(a.specular, at_corners.specular, gouraud);
    }
    a.diffuse = lanes_mul(s->weight, a.diffuse);
    a.specular = lanes_mul(s->weight, a.specular);
    return a;
}

/// Lanes whose hit may get light from this direction. Below the geometric surface there is none. Of a smooth mesh that
/// surface is the curved one, and its shadow rays find out; without shadows the guard stays.
static inline int16 above_surface(const SurfaceLanes* s, constant SceneConstants* constants, Lanes3 direction) {
    const int16 above = lanes_dot(direction, s->geometric_normal) > 0.0f;
    return constants->shadows == SHADOWS_NONE ? above : above | s->smooth;
}

/// Where shadow rays start: where the surface is smooth, above the triangle.
static inline Lanes3 shadow_start(const World* world, const SurfaceLanes* s) {
    const Lanes3 start = leave_surfaces(world, s, 1.0f);
    if (!world->constants->robust_offset || !any16(s->smooth)) return start;
    return lanes_select(start, lanes_add(start, smooth_lift(s)), s->smooth);
}

/// The segments from the hits to the light sample, for hits that are smooth from where their shadow rays start.
static inline void aim(const SurfaceLanes* s, constant SceneConstants* constants, global const LightRecord* light,
                       Lanes3 start, Lanes3 light_position, LightSample* sample) {
    if (!constants->robust_offset || light->type == LIGHT_DIRECTIONAL) return;
    const LightSample lifted = towards(light_position, start);
    sample->distance = select(sample->distance, lifted.distance, s->smooth);
    sample->direction = lanes_select(sample->direction, lifted.direction, s->smooth);
}

/// Writes the shadow rays of one light sample, in the order of the hits and without those that cannot add anything.
/// Returns how many.
COMPILED_ONCE static uint push_shadow_rays(const Shading* s, Lanes3 start, constant SceneConstants* constants,
                                    global const LightRecord* light, LightSlot slot, global ShadowRay* out) {
    Lanes3 light_position;
    LightSample sample = sample_light(light, slot, s->surface.position, s->hits.sample, s->hits.path, &light_position);
    const Answer a = answer(s, light, sample, light_position);
    const int16 adds =
        above_surface(&s->surface, constants, sample.direction) & (lanes_any(a.diffuse) | lanes_any(a.specular));
    aim(&s->surface, constants, light, start, light_position, &sample);

    const Rows from = rows_of(start, sample.distance * LIGHT_REACH);
    const Rows along = rows_of(sample.direction, as_float16(s->hits.pixel));
    const Rows diffuse = rows_of(a.diffuse, as_float16(s->hits.route));
    const Rows specular = rows_of(a.specular, as_float16((uint16)(slot.light)));
    uint count = 0;
    for (uint rest = lane_mask16(adds) & first_lanes(s->hits.count); rest != 0; rest &= rest - 1) {
        const uint lane = lowest_bit(rest);
        global ShadowRay* ray = out + count++;
        store_row(ray->origin, row_of(&from, lane));
        store_row(ray->direction, row_of(&along, lane));
        store_row(ray->diffuse, row_of(&diffuse, lane));
        store_row(ray->specular, row_of(&specular, lane));
    }
    return count;
}

#endif
