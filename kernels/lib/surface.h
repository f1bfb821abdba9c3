// From hits to the surfaces there, sixteen at a time: where, which way they face, and how far a ray must start from
// them. Source of the error bounds: Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 6.8.
#ifndef RAYMILL_SURFACE_H
#define RAYMILL_SURFACE_H

#include "lib/gather.h"

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

/// Index of a primitive's material.
static inline uint material_of(const World* world, uint primitive) {
    const uint triangle_count = world->constants->triangle_count, sphere_count = world->constants->sphere_count;
    if (primitive < triangle_count) return world->triangles[primitive].material;
    const uint index = primitive - triangle_count;
    return index < sphere_count ? world->spheres[index].material : world->planes[index - sphere_count].material;
}

/// Whether the hit's material spawns rays at all; most do not, and need no more work.
static inline bool may_spawn(const World* world, uint primitive) {
    if (primitive == NO_INDEX) return false;
    global const Material* material = world->materials + material_of(world, primitive);
    return material->reflection + material->transmission > 0.0f;
}

/// Index of the object that a primitive belongs to.
static inline uint object_of(const World* world, uint primitive) {
    const uint triangle_count = world->constants->triangle_count, sphere_count = world->constants->sphere_count;
    if (primitive < triangle_count) return world->triangles[primitive].object;
    const uint index = primitive - triangle_count;
    return index < sphere_count ? world->spheres[index].object : world->planes[index - sphere_count].object;
}

/// Up to sixteen hits and the rays that found them. Lanes from `count` on repeat the first one.
typedef struct {
    uint count;
    Lanes3 origin, direction, throughput;
    uint16 pixel, sample, path, route;
    float16 t, u, v;
    uint16 primitive;
} HitLanes;

/// What a corner of a triangle has.
typedef struct {
    Lanes3 position, normal;
    float16 weight;  // barycentric
} CornerLanes;

/// The surfaces of sixteen hits; masks are 0 or ~0.
typedef struct {
    Lanes3 position;
    float16 offset;           // a ray that starts this far along the normal is certainly on that side
    Lanes3 geometric_normal;  // unit; both normals are flipped to the side that the ray came from
    Lanes3 shading_normal;
    float16 uv[2];
    CornerLanes corner[3];  // of triangles
    uint16 material;
    bool one_material;  // all lanes have the same
    int16 is_triangle;
    int16 has_normals;  // all three corners have one; a triangle of which one has none is flat
    int16 smooth;       // the shading normal is interpolated from the vertices
    int16 inside;       // the ray came from behind the outward normal
} SurfaceLanes;

static inline Lanes3 gather3(global const float* words, uint stride, uint16 index) {
    return lanes_xyz(gather4(words, stride, index));
}

/// The hits that `place` names, among rays and hits of the same places.
static inline HitLanes gather_hits(global const Ray* rays, global const Hit* hits, const uint* place, uint count) {
    Lanes4 origin, direction, throughput, hit;
    float16 route;
    if (count == LANES && place[LANES - 1] == place[0] + LANES - 1) {
        global const Ray* ray = rays + place[0];
        origin = load4(ray->origin, WORDS(Ray));
        direction = load4(ray->direction, WORDS(Ray));
        throughput = load4(ray->throughput, WORDS(Ray));
        hit = load4(hits + place[0], WORDS(Hit));
        route = load4(ray->throughput + 1, WORDS(Ray)).w;
    } else {
        uint16 index;
        for (uint lane = 0; lane < LANES; ++lane) ((uint*)&index)[lane] = place[lane < count ? lane : 0];
        origin = gather4(rays->origin, WORDS(Ray), index);
        direction = gather4(rays->direction, WORDS(Ray), index);
        throughput = gather4(rays->throughput, WORDS(Ray), index);
        hit = gather4(hits, WORDS(Hit), index);
        route = gather1(&rays->route, WORDS(Ray), index);
    }
    const HitLanes h = {count,
                        lanes_xyz(origin),
                        lanes_xyz(direction),
                        lanes_xyz(throughput),
                        as_uint16(origin.w),
                        as_uint16(direction.w),
                        as_uint16(throughput.w),
                        as_uint16(route),
                        hit.x,
                        hit.y,
                        hit.z,
                        as_uint16(hit.w)};
    return h;
}

static inline Lanes3 interpolate(const CornerLanes* corner, Lanes3 a, Lanes3 b, Lanes3 c) {
    return lanes_fma(corner[0].weight, a, lanes_fma(corner[1].weight, b, lanes_scale(c, corner[2].weight)));
}

/// Fills in all lanes; what those get that are no triangles is that of triangle 0.
static inline void triangle_surfaces(const World* world, const HitLanes* hits, SurfaceLanes* s) {
    const uint16 triangle = select((uint16)(0), hits->primitive, s->is_triangle);
    const Lanes4 words = gather4(world->triangles->vertex, WORDS(Triangle), triangle);
    const uint16 vertex[3] = {as_uint16(words.x), as_uint16(words.y), as_uint16(words.z)};
    s->material = as_uint16(words.w);
    s->corner[0].weight = 1.0f - hits->u - hits->v;
    s->corner[1].weight = hits->u;
    s->corner[2].weight = hits->v;
    float16 texture_u[3], texture_v[3];
    s->has_normals = (int16)(~0);
#pragma unroll
    for (uint k = 0; k < 3; ++k) {
        const Lanes4 first = gather4(world->vertices->position, WORDS(Vertex), vertex[k]);
        const Lanes4 rest = gather4(world->vertices->normal + 1, WORDS(Vertex), vertex[k]);
        s->corner[k].position = lanes_xyz(first);
        const Lanes3 normal = {first.w, rest.x, rest.y};
        s->corner[k].normal = normal;
        s->has_normals &= lanes_any(normal);
        texture_u[k] = rest.z;
        texture_v[k] = rest.w;
    }
    const Lanes3 a = s->corner[0].position, b = s->corner[1].position, c = s->corner[2].position;
    const float16 wa = s->corner[0].weight, wb = s->corner[1].weight, wc = s->corner[2].weight;
    s->position = interpolate(s->corner, a, b, c);
    s->geometric_normal = lanes_unit(lanes_cross(lanes_sub(b, a), lanes_sub(c, a)));
    // Each coordinate carries at most 4 roundings of the largest vertex coordinate, the offset point one more; times
    // the root of 3 for the normal's direction that is below 9.
    s->offset = 16.0f * ROUNDING * max16(lanes_max_abs(a), max16(lanes_max_abs(b), lanes_max_abs(c)));
    s->uv[0] = fma(wa, texture_u[0], fma(wb, texture_u[1], wc * texture_u[2]));
    s->uv[1] = fma(wa, texture_v[0], fma(wb, texture_v[1], wc * texture_v[2]));
}

/// Normals of triangles between their vertices, where there are such and the material wants them.
static inline void smooth_triangles(SurfaceLanes* s, uint16 shading_flags) {
    const Lanes3 normal = interpolate(s->corner, s->corner[0].normal, s->corner[1].normal, s->corner[2].normal);
    s->smooth =
        s->is_triangle & s->has_normals & ((shading_flags & MATERIAL_FLAT) == 0) & (lanes_dot(normal, normal) > 0.0f);
    if (any16(s->smooth)) s->shading_normal = lanes_select(s->shading_normal, lanes_unit(normal), s->smooth);
}

/// Takes the surface of other primitives in, where there are such.
static inline void put_surfaces(SurfaceLanes* s, int16 where, Lanes3 position, Lanes3 normal, float16 offset,
                                uint16 material) {
    s->position = lanes_select(s->position, position, where);
    s->geometric_normal = lanes_select(s->geometric_normal, normal, where);
    s->offset = select(s->offset, offset, where);
    s->material = select(s->material, material, where);
    s->uv[0] = select(s->uv[0], (float16)(0.0f), where);
    s->uv[1] = select(s->uv[1], (float16)(0.0f), where);
}

static inline void sphere_surfaces(const World* world, uint16 index, Lanes3 hit_point, int16 where, SurfaceLanes* s) {
    const uint16 sphere = select((uint16)(0), index, where);
    const Lanes4 words = gather4(world->spheres->center, WORDS(Sphere), sphere);
    const Lanes3 center = lanes_xyz(words);
    const float16 radius = words.w;
    const Lanes3 normal = lanes_unit(lanes_sub(hit_point, center));
    // The sign of |o - c|^2 - r^2 must come out right: its error is below 8 roundings of r^2, and one rounding of each
    // coordinate of the point and of the offset one.
    const float16 offset = 8.0f * ROUNDING * (radius + lanes_max_abs(center));
    put_surfaces(s, where, lanes_fma(radius, normal, center), normal, offset,
                 as_uint16(gather1(&world->spheres->material, WORDS(Sphere), sphere)));
}

static inline void plane_surfaces(const World* world, uint16 index, Lanes3 hit_point, int16 where, SurfaceLanes* s) {
    const uint16 plane = select((uint16)(0), index, where);
    const Lanes3 point = gather3(world->planes->point, WORDS(Plane), plane);
    const Lanes4 words = gather4(world->planes->normal, WORDS(Plane), plane);
    const Lanes3 normal = lanes_xyz(words);
    const Lanes3 position = lanes_fma(-lanes_dot(normal, lanes_sub(hit_point, point)), normal, hit_point);
    const float16 offset = 16.0f * ROUNDING * (lanes_max_abs(position) + lanes_max_abs(point));
    put_surfaces(s, where, position, normal, offset, as_uint16(words.w));
}

/// Four words of each lane's material, which begin at `words` of material 0.
static inline Lanes4 material4(const World* world, const SurfaceLanes* s, global const float* words) {
    if (s->one_material) return broadcast4(words + (ulong)s->material.s0 * WORDS(Material));
    return gather4(words, WORDS(Material), s->material);
}

static inline uint16 material_flags(const World* world, const SurfaceLanes* s) {
    if (s->one_material) return (uint16)(world->materials[s->material.s0].flags);
    return as_uint16(gather1(&world->materials->flags, WORDS(Material), s->material));
}

/// The surfaces where the rays met what they hit.
static inline void surfaces_at(const World* world, const HitLanes* hits, SurfaceLanes* s) {
    const uint triangle_count = world->constants->triangle_count, sphere_count = world->constants->sphere_count;
    const uint16 index = hits->primitive - triangle_count;
    s->is_triangle = hits->primitive < triangle_count;
    const int16 is_sphere = ~s->is_triangle & (index < sphere_count), is_plane = ~(s->is_triangle | is_sphere);
    if (any16(s->is_triangle)) triangle_surfaces(world, hits, s);
    const Lanes3 hit_point = lanes_fma(hits->t, hits->direction, hits->origin);
    if (any16(is_sphere)) sphere_surfaces(world, index, hit_point, is_sphere, s);
    if (any16(is_plane)) plane_surfaces(world, index - sphere_count, hit_point, is_plane, s);
    s->one_material = !any16(s->material != s->material.s0);
    s->shading_normal = s->geometric_normal;
    s->smooth = (int16)(0);
    if (any16(s->is_triangle)) smooth_triangles(s, material_flags(world, s));
    s->inside = lanes_dot(hits->direction, s->geometric_normal) > 0.0f;
    s->geometric_normal = lanes_select(s->geometric_normal, lanes_minus(s->geometric_normal), s->inside);
    s->shading_normal = lanes_select(s->shading_normal, lanes_minus(s->shading_normal), s->inside);
}

/// From the hits to the curved surface that the vertex normals describe, on the side that the ray came from: shadow
/// rays of smooth triangles start there, so that a coarse mesh casts no steps of shadow on itself at the terminator.
/// Source: Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021, chapter 4.
static inline Lanes3 smooth_lift(const SurfaceLanes* s) {
    const float16 side = select((float16)(1.0f), (float16)(-1.0f), s->inside);
    Lanes3 lift = lanes_of((float3)(0.0f));
#pragma unroll
    for (uint k = 0; k < 3; ++k) {
        const CornerLanes* corner = s->corner + k;
        const Lanes3 normal = lanes_scale(corner->normal, side);  // of any length
        const float16 below = lanes_dot(lanes_sub(s->position, corner->position), normal);
        lift = lanes_fma(corner->weight * positive16(-below) / lanes_dot(normal, normal), normal, lift);
    }
    return lift;
}

/// Where rays must start to leave the surfaces on the side that they came from, or (side < 0) on the other.
static inline Lanes3 leave_surfaces(const World* world, const SurfaceLanes* s, float side) {
    if (!world->constants->robust_offset) return s->position;
    return lanes_fma(side * s->offset, s->geometric_normal, s->position);
}

#endif
