// Visibility of the light samples; what is not blocked adds its term.
// Reads:  shadow_rays and shadow_counts, segments of CHUNK.
// Writes: film; counters->shadow_traced and shadow_blocked.
// Next:   the next range of light samples, or secondary.

#include "lib/film.h"
#include "lib/trace.h"
#include "lib/transmittance.h"

/// One work-item a segment, or one ray where rays are traced alone.
kernel void shadow(global const ShadowRay* shadow_rays, global const uint* shadow_counts, uint segment_count,
                   global const BvhNode* nodes, global const TriangleBlock* triangle_blocks,
                   global const SphereBlock* sphere_blocks, global const Plane* planes,
                   global const Triangle* triangles, global const Sphere* spheres, global const Material* materials,
                   constant SceneConstants* constants, global long* film_sums, global Counters* counters,
                   uint film_flags) {
    counters += film_flags >> FILM_PASS_SHIFT;
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
    uint blocked = 0, atomics = 0;
    Terms terms = {.count = 0};
    for (uint i = 0; i < count; ++i) {
        global const ShadowRay* ray = rays + i;
        float3 left = (float3)(1.0f);
        if (!all_clear && blockers[i] != NO_INDEX) {
            left = filter_of(&world, blockers[i]);
            // Another surface on the way may block what this one lets through.
            if (any(left != 0.0f))
                left = transmittance(&geometry, &world, load3(ray->origin), load3(ray->direction), ray->t_max);
        }
        if (ray->route == ROUTE_CAMERA && film_keeps(&film, FILM_SHADOW)) {
            atomics += film_add(&film, FILM_SHADOW, ray->pixel, (float4)(left, 1.0f));
        }
        if (any(left != 0.0f)) {
            terms_put(&terms, ray->pixel, ray->route, left * load3(ray->diffuse), left * load3(ray->specular));
            if (terms.count == LANES) atomics += film_add_terms(&film, FILM_DIFFUSE, FILM_SPECULAR, &terms);
        } else {
            ++blocked;
        }
    }
    atomics += film_add_terms(&film, FILM_DIFFUSE, FILM_SPECULAR, &terms);
    atomics += film_count(&counters->shadow_traced, count);
    atomics += film_count(&counters->shadow_blocked, blocked);
    film_count_atomics(&film, atomics);
}
