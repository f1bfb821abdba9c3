// From a hit to the surface there: where, which way it faces, and how far a ray must start from it.
// Source of the error bounds: Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 6.8.
#ifndef RAYMILL_SURFACE_H
#define RAYMILL_SURFACE_H

#include "lib/traverse.h"

/// What shading reads beside the hierarchy.
typedef struct {
    global const Vertex* vertices;
    global const Triangle* triangles;
    global const Sphere* spheres;
    global const Plane* planes;
    global const Material* materials;
    global const Texture* textures;
    global const float* texels;
    constant SceneConstants* constants;
} World;

typedef struct {
    float3 position;
    float offset;             // a ray that starts this far along the normal is certainly on that side
    float3 geometric_normal;  // unit; both normals are flipped to the side that the ray came from
    float3 shading_normal;
    float2 uv;
    float3 weights;  // barycentric
    uint triangle;   // NO_INDEX: a sphere or a plane
    uint material;
    bool smooth;     // the shading normal is interpolated from the vertices
    bool inside;     // the ray came from behind the outward normal
} Surface;

static inline float3 interpolate(float3 a, float3 b, float3 c, float3 weights) {
    return fma3(weights.x, a, fma3(weights.y, b, c * weights.z));
}

static inline float max_abs(float3 v) { return max3(fabs(v)); }

/// Whether all three vertices have a normal; a triangle of which one has none is flat.
static inline bool has_normals(const World* world, global const Triangle* triangle) {
    bool all_there = true;
    for (uint corner = 0; corner < 3; ++corner)
        all_there &= any(load3(world->vertices[triangle->vertex[corner]].normal) != 0.0f);
    return all_there;
}

static inline void triangle_surface(const World* world, Hit hit, uint shading_flags, Surface* s) {
    global const Triangle* triangle = world->triangles + hit.primitive;
    global const Vertex* a = world->vertices + triangle->vertex[0];
    global const Vertex* b = world->vertices + triangle->vertex[1];
    global const Vertex* c = world->vertices + triangle->vertex[2];
    const float3 pa = load3(a->position), pb = load3(b->position), pc = load3(c->position);
    s->weights = (float3)(1.0f - hit.u - hit.v, hit.u, hit.v);
    s->position = interpolate(pa, pb, pc, s->weights);
    s->geometric_normal = unit3(cross3(pb - pa, pc - pa));
    // Each coordinate carries at most 4 roundings of the largest vertex coordinate, the offset point one more; times the
    // root of 3 for the normal's direction that is below 9.
    s->offset = 16.0f * ROUNDING * fmax(max_abs(pa), fmax(max_abs(pb), max_abs(pc)));
    s->triangle = hit.primitive;
    s->uv = (float2)(fma(s->weights.x, a->uv[0], fma(s->weights.y, b->uv[0], s->weights.z * c->uv[0])),
                     fma(s->weights.x, a->uv[1], fma(s->weights.y, b->uv[1], s->weights.z * c->uv[1])));
    s->shading_normal = s->geometric_normal;
    if (shading_flags & MATERIAL_FLAT) return;
    if (!has_normals(world, triangle)) return;
    const float3 smooth = interpolate(load3(a->normal), load3(b->normal), load3(c->normal), s->weights);
    s->smooth = dot3(smooth, smooth) > 0.0f;
    if (s->smooth) s->shading_normal = unit3(smooth);
}

static inline void sphere_surface(const World* world, uint index, float3 hit_point, Surface* s) {
    global const Sphere* sphere = world->spheres + index;
    const float3 center = load3(sphere->center);
    s->geometric_normal = unit3(hit_point - center);
    s->shading_normal = s->geometric_normal;
    s->position = fma3(sphere->radius, s->geometric_normal, center);
    // The sign of |o - c|^2 - r^2 must come out right: its error is below 8 roundings of r^2, and one rounding of each
    // coordinate of the point and of the offset one.
    s->offset = 8.0f * ROUNDING * (sphere->radius + max_abs(center));
}

static inline void plane_surface(const World* world, uint index, float3 hit_point, Surface* s) {
    global const Plane* plane = world->planes + index;
    const float3 normal = load3(plane->normal), point = load3(plane->point);
    s->geometric_normal = normal;
    s->shading_normal = normal;
    s->position = fma3(-dot3(normal, hit_point - point), normal, hit_point);
    s->offset = 16.0f * ROUNDING * (max_abs(s->position) + max_abs(point));
}

/// Index of a primitive's material.
static inline uint material_of(const World* world, uint primitive) {
    const uint triangle_count = world->constants->triangle_count, sphere_count = world->constants->sphere_count;
    if (primitive < triangle_count) return world->triangles[primitive].material;
    const uint index = primitive - triangle_count;
    return index < sphere_count ? world->spheres[index].material : world->planes[index - sphere_count].material;
}

/// Whether the material spawns rays at all; most do not, and need no more work.
static inline bool passes_light_on(global const Material* material) {
    return material->reflection + material->transmission > 0.0f;
}

static inline bool may_spawn(const World* world, uint primitive) {
    return primitive != NO_INDEX && passes_light_on(world->materials + material_of(world, primitive));
}

/// Index of the object that a primitive belongs to.
static inline uint object_of(const World* world, uint primitive) {
    const uint triangle_count = world->constants->triangle_count, sphere_count = world->constants->sphere_count;
    if (primitive < triangle_count) return world->triangles[primitive].object;
    const uint index = primitive - triangle_count;
    return index < sphere_count ? world->spheres[index].object : world->planes[index - sphere_count].object;
}

/// The surface where the ray met hit.primitive.
static inline Surface surface_at(const World* world, float3 origin, float3 direction, Hit hit) {
    const uint triangle_count = world->constants->triangle_count;
    const uint sphere_count = world->constants->sphere_count;
    Surface s;
    s.material = material_of(world, hit.primitive);
    s.triangle = NO_INDEX;
    s.smooth = false;
    s.uv = (float2)(0.0f);
    s.weights = (float3)(1.0f, 0.0f, 0.0f);
    if (hit.primitive < triangle_count) {
        triangle_surface(world, hit, world->materials[s.material].flags, &s);
    } else {
        const float3 hit_point = fma3(hit.t, direction, origin);
        const uint index = hit.primitive - triangle_count;
        if (index < sphere_count)
            sphere_surface(world, index, hit_point, &s);
        else
            plane_surface(world, index - sphere_count, hit_point, &s);
    }
    s.inside = dot3(direction, s.geometric_normal) > 0.0f;
    if (s.inside) {
        s.geometric_normal = -s.geometric_normal;
        s.shading_normal = -s.shading_normal;
    }
    return s;
}

/// From the hit to the curved surface that the vertex normals describe, on the side that the ray came from: shadow rays of
/// smooth triangles start there, so that a coarse mesh casts no steps of shadow on itself at the terminator.
/// Source: Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021, chapter 4.
static inline float3 smooth_lift(const World* world, const Surface* s) {
    global const Triangle* triangle = world->triangles + s->triangle;
    const float weights[3] = {s->weights.x, s->weights.y, s->weights.z};
    float3 lift = (float3)(0.0f);
    for (uint corner = 0; corner < 3; ++corner) {
        global const Vertex* vertex = world->vertices + triangle->vertex[corner];
        const float3 normal = unit3(load3(vertex->normal)) * (s->inside ? -1.0f : 1.0f);
        const float below = dot3(s->position - load3(vertex->position), normal);
        lift = fma3(weights[corner] * fmax(-below, 0.0f), normal, lift);
    }
    return lift;
}

/// Where a ray must start to leave the surface on the side that the ray came from, or (side < 0) on the other.
static inline float3 leave_surface(const World* world, const Surface* s, float side) {
    if (!world->constants->robust_offset) return s->position;
    return fma3(side * s->offset, s->geometric_normal, s->position);
}

#endif
