// Visibility of the light samples; what is not blocked adds its term.
// Reads:  shadow_rays and shadow_counts, segments of CHUNK.
// Writes: film; counters->shadow_traced and shadow_blocked.
// Next:   the next range of light samples, or secondary.

#include "lib/film.h"
#include "lib/trace.h"
#include "lib/transmittance.h"

/// The terms of up to sixteen rays in a row; the last one's again where there are fewer.
static inline void load_terms(global const ShadowRay* rays, uint count, Terms* terms) {
    terms->lanes = first_lanes(count);
    terms->covered = 0;
    terms->first = load_rows(rays->diffuse, WORDS(ShadowRay), count);
    terms->second = load_rows(rays->specular, WORDS(ShadowRay), count);
    for (uint lane = 0; lane < LANES; ++lane) {
        global const ShadowRay* ray = rays + min(lane, count - 1);
        terms->pixel[lane] = ray->pixel;
        terms->route[lane] = ray->route;
    }
}

/// What is left of a ray's light behind a primitive in its way.
static inline float3 light_left(const Geometry* geometry, const World* world, global const ShadowRay* ray,
                                uint blocker) {
    const float3 left = filter_of(world, blocker);
    if (!any(left != 0.0f)) return left;
    // Another surface on the way may block what this one lets through.
    return transmittance(geometry, world, load3(ray->origin), load3(ray->direction), ray->t_max);
}

/// Brings home what is left of the light of up to sixteen rays in a row. Something, `blockers`, is in the way of those
/// that have a bit set. `blocked` grows by rays of which nothing is left. Returns the atomic operations.
COMPILED_ONCE static uint add_light(const Film* film, const Geometry* geometry, const World* world,
                                    global const ShadowRay* rays, uint count, uint in_the_way, const uint* blockers,
                                    uint* blocked) {
    Terms terms;
    load_terms(rays, count, &terms);
    // What is left of the light, and a count: the shadow plane's, where the camera looks.
    Rows arriving = {{(float16)(1.0f), (float16)(1.0f), (float16)(1.0f), (float16)(1.0f)}};
    const uint lanes = terms.lanes;
    for (uint rest = in_the_way & lanes; rest != 0; rest &= rest - 1) {
        const uint lane = lowest_bit(rest);
        const float3 left = light_left(geometry, world, rays + lane, blockers[lane]);
        ((float4*)&arriving)[lane] = (float4)(left, 1.0f);
        if (any(left != 0.0f)) {
            ((float4*)&terms.first)[lane] *= (float4)(left, 0.0f);
            ((float4*)&terms.second)[lane] *= (float4)(left, 0.0f);
        } else {
            terms.lanes &= ~(1u << lane);
            ++*blocked;
        }
    }
    uint atomics = 0;
    if (film_keeps(film, FILM_SHADOW)) {
        const uint seen = lanes & lanes_of_route(terms.route, ROUTE_CAMERA);
        atomics = film_add_values(film, FILM_SHADOW, terms.pixel, &arriving, seen);
    }
    return atomics + film_add_terms(film, FILM_DIFFUSE, FILM_SPECULAR, &terms);
}

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
    ulong in_the_way = 0;
    if (constants->shadows != SHADOWS_NONE) in_the_way = find_blockers(&geometry, rays, count, blockers);
    uint blocked = 0, atomics = 0;
    for (uint begin = 0; begin < count; begin += LANES)
        atomics += add_light(&film, &geometry, &world, rays + begin, min((uint)LANES, count - begin),
                             (uint)(in_the_way >> begin), blockers + begin, &blocked);
    atomics += film_count(&counters->shadow_traced, count);
    atomics += film_count(&counters->shadow_blocked, blocked);
    film_count_atomics(&film, atomics);
}
