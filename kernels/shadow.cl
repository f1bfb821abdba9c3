// Visibility of the light samples; what is not blocked adds its term.
// Reads:  shadow_rays and shadow_counts, segments of CHUNK.
// Writes: film.
// Next:   the next range of light samples, or secondary.

#include "lib/film.h"
#include "lib/packet.h"
#include "lib/surface.h"

/// Finds out for a segment of shadow rays what nothing at all stands in the way of: one bit a ray. The others are blocked,
/// or filtered.
#ifdef RAYMILL_PACKETS
static ulong clear_rays(const Geometry* geometry, global const ShadowRay* rays, uint count) {
    Packet packet;
    for (uint i = 0; i < count; ++i) chunk_add(&packet.rays, i, rays[i].origin, rays[i].direction, rays[i].t_max);
    chunk_prepare(&packet.rays, count);
    traverse_chunk(geometry, &packet, true);
    ulong clear = 0;
    for (uint i = 0; i < count; ++i)
        if (chunk_hit(&packet.rays, i).primitive == NO_INDEX) clear |= 1ul << i;
    return clear;
}
#else
static ulong clear_rays(const Geometry* geometry, global const ShadowRay* rays, uint count) {
    ulong clear = 0;
    for (uint i = 0; i < count; ++i)
        if (!is_blocked(geometry, load3(rays[i].origin), load3(rays[i].direction), rays[i].t_max)) clear |= 1ul << i;
    return clear;
}
#endif

/// Whether a surface in the way may let some light through.
static inline bool filters(constant SceneConstants* constants) {
    return constants->shadows == SHADOWS_FILTERED && constants->any_filter;
}

/// What is left of light from t_max away after what stands in its way: filtered by every transmissive surface, each
/// crossing once.
static inline float3 transmittance(const Geometry* geometry, const World* world, global const ShadowRay* ray) {
    const float3 origin = load3(ray->origin), direction = load3(ray->direction);
    // In the order of distance, so that the product's bits do not depend on the hierarchy.
    float3 left = (float3)(1.0f);
    Hit hit = {0.0f, 0.0f, 0.0f, NO_INDEX};
    for (;;) {
        hit = closest_hit_after(geometry, origin, direction, hit, ray->t_max);
        if (hit.primitive == NO_INDEX) return left;
        global const Material* filter = world->materials + material_of(world, hit.primitive);
        left *= load3(filter->base_color) * filter->transmission;
        if (!any(left != 0.0f)) return left;
    }
}

/// One work-item a segment.
kernel void shadow(global const ShadowRay* shadow_rays, global const uint* shadow_counts, uint segment_count,
                   global const BvhNode* nodes, global const TriangleBlock* triangle_blocks,
                   global const SphereBlock* sphere_blocks, global const Plane* planes,
                   global const Triangle* triangles, global const Sphere* spheres, global const Material* materials,
                   constant SceneConstants* constants, global long* film_sums, global Counters* counters,
                   uint pixels_once) {
    const Film film = {film_sums, counters, constants, pixels_once != 0};
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const World world = {0, triangles, spheres, planes, materials, 0, 0, constants};
    const uint segment = get_global_id(0);
    if (segment >= segment_count) return;
    const uint count = shadow_counts[segment];
    if (count == 0) return;
    const ulong clear =
        constants->shadows == SHADOWS_NONE ? ~0ul : clear_rays(&geometry, shadow_rays + segment * CHUNK, count);
    uint blocked = 0;
    for (uint i = 0; i < count; ++i) {
        global const ShadowRay* ray = shadow_rays + segment * CHUNK + i;
        float3 left = clear >> i & 1ul ? (float3)(1.0f) : (float3)(0.0f);
        if (!(clear >> i & 1ul) && filters(constants)) left = transmittance(&geometry, &world, ray);
        if (ray->route == ROUTE_CAMERA && film_keeps(&film, FILM_SHADOW)) {
            film_add(&film, FILM_SHADOW, ray->pixel, left);
            film_add_units(&film, film_pixel(&film, FILM_SHADOW, ray->pixel) + 3, FILM_ONE);
        }
        if (any(left != 0.0f)) {
            film_add_two(&film, ray->route, ray->pixel, FILM_DIFFUSE, left * load3(ray->diffuse), FILM_SPECULAR,
                         left * load3(ray->specular));
        } else {
            ++blocked;
        }
    }
    atom_add(&counters->shadow_traced, (ulong)count);
    if (blocked != 0) atom_add(&counters->shadow_blocked, (ulong)blocked);
}
