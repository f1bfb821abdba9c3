// The lecture's local illumination, sixteen hits at a time, up to the question whether the light is visible.
#ifndef RAYMILL_LIGHTING_H
#define RAYMILL_LIGHTING_H

#include "lib/light.h"
#include "lib/shading.h"

/// What Phong's formula needs at a vertex of a Gouraud-shaded triangle.
typedef struct {
    float position[3][LANES];
    float normal[3][LANES];  // unit, on the side that the ray came from
    float to_eye[3][LANES];
    float weight[LANES];  // barycentric
} CornerLanes;

/// Up to sixteen hits as structure of arrays; lanes from `count` on hold numbers that nobody looks at.
typedef struct {
    uint count;
    bool any_gouraud, any_blinn;
    float position[3][LANES];
    float geometric_normal[3][LANES];
    float shading_normal[3][LANES];
    float to_eye[3][LANES];
    float start[3][LANES];     // of shadow rays
    float diffuse[3][LANES];   // k_d
    float specular[3][LANES];  // k_s
    float weight[3][LANES];    // of both terms
    float shininess[LANES];
    int smooth[LANES], blinn[LANES], gouraud[LANES];  // 0 or ~0
    uint sample[LANES], path[LANES], pixel[LANES], route[LANES];
    CornerLanes corner[3];  // where `gouraud`
} HitLanes;

static inline void put_corners(HitLanes* hits, uint lane, const World* world, const Shading* s) {
    global const Triangle* triangle = world->triangles + s->surface.triangle;
    const float3 origin = load3(s->ray->origin);
    const float side = s->surface.inside ? -1.0f : 1.0f;
    const bool has_own = has_normals(world, triangle);
    const float weights[3] = {s->surface.weights.x, s->surface.weights.y, s->surface.weights.z};
    for (uint k = 0; k < 3; ++k) {
        CornerLanes* corner = hits->corner + k;
        global const Vertex* vertex = world->vertices + triangle->vertex[k];
        const float3 p = load3(vertex->position);
        const float3 n = has_own ? unit3(load3(vertex->normal)) * side : s->surface.geometric_normal;
        lane_put(corner->position, lane, p);
        lane_put(corner->normal, lane, n);
        lane_put(corner->to_eye, lane, any(origin != p) ? unit3(origin - p) : s->to_eye);
        corner->weight[lane] = weights[k];
    }
}

/// Takes a hit in: hits->count must be below LANES.
static inline void put_hit(HitLanes* hits, const World* world, const Shading* s) {
    const uint lane = hits->count++;
    const bool robust = world->constants->robust_offset != 0;
    // Where the surface is smooth, shadow rays start above the triangle.
    float3 start = leave_surface(world, &s->surface, 1.0f);
    if (s->surface.smooth && robust) start += smooth_lift(world, &s->surface);
    lane_put(hits->position, lane, s->surface.position);
    lane_put(hits->geometric_normal, lane, s->surface.geometric_normal);
    lane_put(hits->shading_normal, lane, s->surface.shading_normal);
    lane_put(hits->to_eye, lane, s->to_eye);
    lane_put(hits->start, lane, start);
    lane_put(hits->diffuse, lane, s->diffuse);
    lane_put(hits->specular, lane, load3(s->material->specular));
    lane_put(hits->weight, lane, s->weight);
    hits->shininess[lane] = s->material->shininess;
    hits->smooth[lane] = s->surface.smooth ? ~0 : 0;
    hits->sample[lane] = s->ray->sample;
    hits->path[lane] = s->ray->path;
    hits->pixel[lane] = s->ray->pixel;
    hits->route[lane] = s->ray->route;
    const bool blinn = (s->material->flags & MATERIAL_BLINN) != 0;
    const bool gouraud = (s->material->flags & MATERIAL_GOURAUD) && s->surface.triangle != NO_INDEX;
    hits->blinn[lane] = blinn ? ~0 : 0;
    hits->gouraud[lane] = gouraud ? ~0 : 0;
    hits->any_blinn |= blinn;
    hits->any_gouraud |= gouraud;
    if (gouraud) put_corners(hits, lane, world, s);
}

/// max(n.l, 0) and the highlight's cosine to the power of the shininess, both 0 where the light is behind the normal.
/// Unit vectors; l towards the light, v towards the eye.
static inline void phong_terms(const HitLanes* hits, Lanes3 n, Lanes3 l, Lanes3 v, float16* diffuse,
                               float16* specular) {
    const float16 cosine = lanes_dot(n, l);
    float16 highlight = lanes_dot(v, lanes_fma(2.0f * cosine, n, lanes_minus(l)));
    if (hits->any_blinn) {
        const Lanes3 sum = lanes_add(l, v);
        const float16 length = lanes_length(sum);
        const float16 halfway = select((float16)(0.0f), lanes_dot(n, sum) / length, length > 0.0f);
        highlight = select(highlight, halfway, vload16(0, hits->blinn));
    }
    float base[LANES], powers[LANES];
    vstore16(positive16(highlight), 0, base);
    for (uint lane = 0; lane < LANES; ++lane) powers[lane] = power(base[lane], hits->shininess[lane]);
    *diffuse = positive16(cosine);
    *specular = select((float16)(0.0f), vload16(0, powers), cosine > 0.0f);
}

/// Light that the surface gives back of one light sample, with and without direction; colours included.
typedef struct {
    Lanes3 diffuse, specular;
} Answer;

static inline Answer phong_answer(const HitLanes* hits, LightSample light) {
    float16 diffuse, specular;
    phong_terms(hits, lanes_load(hits->shading_normal), light.direction, lanes_load(hits->to_eye), &diffuse, &specular);
    const Answer a = {lanes_scale(lanes_mul(lanes_load(hits->diffuse), light.incoming), diffuse),
                      lanes_scale(lanes_mul(lanes_load(hits->specular), light.incoming), specular)};
    return a;
}

/// Gouraud: Phong's formula at the three vertices with their normals, the results interpolated.
/// An area light's I_in is that at the hit; other lights are attenuated at each vertex.
static inline Answer gouraud_answer(const HitLanes* hits, global const LightRecord* light, LightSample sample,
                                    Lanes3 light_position) {
    Lanes3 diffuse_light = lanes_of((float3)(0.0f)), specular_light = diffuse_light;
    for (uint k = 0; k < 3; ++k) {
        const CornerLanes* corner = hits->corner + k;
        const Lanes3 p = lanes_load(corner->position);
        LightSample at_vertex = sample;
        if (light->type == LIGHT_POINT || light->type == LIGHT_SPOT)
            at_vertex = from_position(light, light_position, p);
        else if (light->type != LIGHT_DIRECTIONAL)
            at_vertex.direction = towards(light_position, p).direction;
        float16 diffuse, specular;
        phong_terms(hits, lanes_load(corner->normal), at_vertex.direction, lanes_load(corner->to_eye), &diffuse,
                    &specular);
        const float16 weight = vload16(0, corner->weight);
        const int16 lit = diffuse != 0.0f;  // I_in is not a number where the light lies on the vertex
        diffuse_light =
            lanes_select(diffuse_light, lanes_fma(weight * diffuse, at_vertex.incoming, diffuse_light), lit);
        specular_light =
            lanes_select(specular_light, lanes_fma(weight * specular, at_vertex.incoming, specular_light), lit);
    }
    const Answer a = {lanes_mul(lanes_load(hits->diffuse), diffuse_light),
                      lanes_mul(lanes_load(hits->specular), specular_light)};
    return a;
}

static inline Answer answer(const HitLanes* hits, global const LightRecord* light, LightSample sample,
                            Lanes3 light_position) {
    Answer a = phong_answer(hits, sample);
    if (hits->any_gouraud) {
        const Answer gouraud = gouraud_answer(hits, light, sample, light_position);
        const int16 where = vload16(0, hits->gouraud);
        a.diffuse = lanes_select(a.diffuse, gouraud.diffuse, where);
        a.specular = lanes_select(a.specular, gouraud.specular, where);
    }
    const Lanes3 weight = lanes_load(hits->weight);
    a.diffuse = lanes_mul(weight, a.diffuse);
    a.specular = lanes_mul(weight, a.specular);
    return a;
}

/// Lanes whose hit may get light from this direction. Below the geometric surface there is none. Of a smooth mesh that
/// surface is the curved one, and its shadow rays find out; without shadows the guard stays.
static inline int16 above_surface(const HitLanes* hits, constant SceneConstants* constants, Lanes3 direction) {
    const int16 above = lanes_dot(direction, lanes_load(hits->geometric_normal)) > 0.0f;
    return constants->shadows == SHADOWS_NONE ? above : above | vload16(0, hits->smooth);
}

/// The segments from the hits to the light sample, for hits that are smooth from where their shadow rays start.
static inline void aim(const HitLanes* hits, constant SceneConstants* constants, global const LightRecord* light,
                       Lanes3 light_position, LightSample* sample) {
    if (!constants->robust_offset || light->type == LIGHT_DIRECTIONAL) return;
    const LightSample lifted = towards(light_position, lanes_load(hits->start));
    const int16 smooth = vload16(0, hits->smooth);
    sample->distance = select(sample->distance, lifted.distance, smooth);
    sample->direction = lanes_select(sample->direction, lifted.direction, smooth);
}

/// Writes the shadow rays of one light sample, in the order of the hits and without those that cannot add anything.
/// Returns how many.
static inline uint push_shadow_rays(const HitLanes* hits, constant SceneConstants* constants,
                                    global const LightRecord* light, LightSlot slot, global ShadowRay* out) {
    Lanes3 light_position;
    LightSample sample =
        sample_light(light, slot, lanes_load(hits->position), hits->sample, hits->path, &light_position);
    const Answer a = answer(hits, light, sample, light_position);
    const int16 adds =
        above_surface(hits, constants, sample.direction) & (lanes_any(a.diffuse) | lanes_any(a.specular));
    aim(hits, constants, light, light_position, &sample);

    float direction[3][LANES], diffuse[3][LANES], specular[3][LANES], t_max[LANES];
    int pushed[LANES];
    lanes_store(direction, sample.direction);
    lanes_store(diffuse, a.diffuse);
    lanes_store(specular, a.specular);
    vstore16(sample.distance * LIGHT_REACH, 0, t_max);
    vstore16(adds, 0, pushed);
    uint count = 0;
    for (uint lane = 0; lane < hits->count; ++lane) {
        if (!pushed[lane]) continue;
        global ShadowRay* ray = out + count++;
        store3(ray->origin, lane_get(hits->start, lane));
        ray->t_max = t_max[lane];
        store3(ray->direction, lane_get(direction, lane));
        ray->pixel = hits->pixel[lane];
        store3(ray->diffuse, lane_get(diffuse, lane));
        ray->route = hits->route[lane];
        store3(ray->specular, lane_get(specular, lane));
        ray->light = slot.light;
    }
    return count;
}

#endif
