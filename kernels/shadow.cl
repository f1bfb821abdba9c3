// Visibility of the light samples; what is not blocked adds its term.
// Reads:  shadow_rays and shadow_counts, segments of CHUNK.
// Writes: film; counters->shadow_traced and shadow_blocked.
// Next:   the next range of light samples, or secondary.

#include "lib/film.h"
#include "lib/packet.h"
#include "lib/surface.h"

/// For each of a segment's shadow rays some primitive that stands in its way, or NO_INDEX.
#ifdef RAYMILL_PACKETS
static void find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count, uint* blockers) {
    Packet packet;
    for (uint i = 0; i < count; ++i) chunk_add(&packet.rays, i, rays[i].origin, rays[i].direction, rays[i].t_max);
    chunk_prepare(&packet.rays, count);
    traverse_chunk(geometry, &packet, true);
    for (uint i = 0; i < count; ++i) blockers[i] = chunk_hit(&packet.rays, i).primitive;
}
#else
static void find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count, uint* blockers) {
    for (uint i = 0; i < count; ++i)
        blockers[i] =
            any_hit_before(geometry, load3(rays[i].origin), load3(rays[i].direction), rays[i].t_max).primitive;
}
#endif

/// What a primitive in the way leaves of the light: all black if it blocks it.
static inline float3 filter_of(const World* world, uint primitive) {
    if (world->constants->shadows != SHADOWS_FILTERED || !world->constants->any_filter) return (float3)(0.0f);
    global const Material* material = world->materials + material_of(world, primitive);
    return load3(material->base_color) * material->transmission;
}

/// What is left of light from t_max away: filtered by every transmissive surface on the way, each crossing once.
static inline float3 transmittance(const Geometry* geometry, const World* world, global const ShadowRay* ray) {
    const float3 origin = load3(ray->origin), direction = load3(ray->direction);
    // In the order of distance, so that the product's bits do not depend on the hierarchy.
    float3 left = (float3)(1.0f);
    Hit hit = no_hit(0.0f);
    for (;;) {
        hit = closest_hit_after(geometry, origin, direction, hit, ray->t_max);
        if (hit.primitive == NO_INDEX) return left;
        left *= filter_of(world, hit.primitive);
        if (!any(left != 0.0f)) return left;
    }
}

/// One work-item a segment, or one ray where rays are traced alone.
kernel void shadow(global const ShadowRay* shadow_rays, global const uint* shadow_counts, uint segment_count,
                   global const BvhNode* nodes, global const TriangleBlock* triangle_blocks,
                   global const SphereBlock* sphere_blocks, global const Plane* planes,
                   global const Triangle* triangles, global const Sphere* spheres, global const Material* materials,
                   constant SceneConstants* constants, global long* film_sums, global Counters* counters,
                   uint film_flags) {
    const Film film = {film_sums, counters, constants, film_flags, ATOMICS_SHADOW};
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const World world = {0, triangles, spheres, planes, materials, 0, 0, constants};
    const uint first = get_global_id(0) * RAYS_A_WORK_ITEM % CHUNK;
    const uint segment = get_global_id(0) * RAYS_A_WORK_ITEM / CHUNK;
    if (segment >= segment_count || first >= shadow_counts[segment]) return;
    global const ShadowRay* rays = shadow_rays + segment * CHUNK + first;
    const uint count = min((uint)RAYS_A_WORK_ITEM, shadow_counts[segment] - first);
    uint blockers[RAYS_A_WORK_ITEM];
    const bool all_clear = constants->shadows == SHADOWS_NONE;
    if (!all_clear) find_blockers(&geometry, rays, count, blockers);
    uint blocked = 0, adds = 0;
    for (uint i = 0; i < count; ++i) {
        global const ShadowRay* ray = rays + i;
        float3 left = (float3)(1.0f);
        if (!all_clear && blockers[i] != NO_INDEX) {
            left = filter_of(&world, blockers[i]);
            // Another surface on the way may block what this one lets through.
            if (any(left != 0.0f)) left = transmittance(&geometry, &world, ray);
        }
        if (ray->route == ROUTE_CAMERA && film_keeps(&film, FILM_SHADOW)) {
            adds += film_add(&film, FILM_SHADOW, ray->pixel, left);
            adds += film_add_units(&film, film_pixel(&film, FILM_SHADOW, ray->pixel) + 3, FILM_ONE);
        }
        if (any(left != 0.0f)) {
            adds += film_add_two(&film, ray->route, ray->pixel, FILM_DIFFUSE, left * load3(ray->diffuse), FILM_SPECULAR,
                                 left * load3(ray->specular));
        } else {
            ++blocked;
        }
    }
    const uint pops = film_count(&counters->shadow_traced, count) + film_count(&counters->shadow_blocked, blocked);
    film_count_atomics(&film, adds, pops);
}
