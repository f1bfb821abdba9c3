// Local illumination: ambient, emission, coverage, and one shadow ray for each light sample that would add something.
// Reads:  rays [first_ray, first_ray + count), hits [0, count), light samples [first_slot, first_slot + slot_count).
// Writes: film (ambient, emission and coverage, with slot 0); shadow_rays and shadow_counts, a segment of CHUNK rays
//         for each chunk and light sample, so that its rays go to one light in the order of their pixels;
//         counters->shadow_rays, and with slot 0 missed and passing, where the frame is profiled.
// Next:   shadow.

#include "lib/film.h"
#include "lib/lighting.h"

/// Ambient light, emission, and the coverage of camera rays.
COMPILED_ONCE static uint add_local_light(const Film* film, const World* world, const Shading* s) {
    Terms terms;
    terms.lanes = first_lanes(s->hits.count);
    terms.covered = lane_mask16(s->hits.route == ROUTE_CAMERA) & terms.lanes;
    vstore16(s->hits.pixel, 0, terms.pixel);
    vstore16(s->hits.route, 0, terms.route);
    terms.first = rows_of(ambient_radiance(world, s), (float16)(0.0f));
    terms.second = rows_of(emitted_radiance(world, s), (float16)(0.0f));
    return film_add_terms(film, FILM_AMBIENT, FILM_EMISSION, &terms);
}

/// Light samples of a launch, and where a chunk's shadow rays to them go, a segment each.
typedef struct {
    global const LightRecord* lights;
    global const LightSlot* slots;
    uint count;
    bool with_local_light;
    global ShadowRay* segments;
    uint pushed[SHADOW_SAMPLES];
} ChunkLights;

/// Shades those hits of a chunk that `place` names, up to sixteen; `passing` grows by those that pass light on. Returns
/// the atomic operations.
COMPILED_ONCE static uint shade_lanes(const Film* film, const World* world, global const Ray* rays,
                                      global const Hit* hits, const uint* place, uint count, ChunkLights* l,
                                      uint* passing) {
    Shading shading;
    shading.hits = gather_hits(rays, hits, place, count);
    shade_hits(world, &shading);
    const uint atomics = l->with_local_light ? add_local_light(film, world, &shading) : 0;
    *passing += popcount(shading.passing);
    if (!answers_light(&shading)) return atomics;
    const Lanes3 start = shadow_start(world, &shading.surface);
    for (uint k = 0; k < l->count; ++k) {
        global ShadowRay* end = l->segments + k * CHUNK + l->pushed[k];
        l->pushed[k] +=
            push_shadow_rays(&shading, start, world->constants, l->lights + l->slots[k].light, l->slots[k], end);
    }
    return atomics;
}

/// One work-item a chunk of CHUNK hits; segment = chunk * slot_count + slot.
kernel void shade(global const Ray* rays, uint first_ray, uint count, global const Hit* hits, uint first_slot,
                  uint slot_count, global const LightSlot* slots, global const LightRecord* lights,
                  global const Vertex* vertices, global const Triangle* triangles, global const Sphere* spheres,
                  global const Plane* planes, global const Material* materials, global const Texture* textures,
                  global const float* texels, constant SceneConstants* constants, global ShadowRay* shadow_rays,
                  global uint* shadow_counts, global long* film_sums, global Counters* counters, uint film_flags) {
    counters += film_flags >> FILM_PASS_SHIFT;
    const Film film = {film_sums, counters, constants, film_flags, ATOMICS_SHADE};
    const World world = {vertices, triangles, spheres, planes, materials, textures, texels, constants};
    const uint chunk = get_global_id(0);
    const uint begin = chunk * CHUNK;
    if (begin >= count) return;
    const uint end = min(begin + CHUNK, count);
    uint places[CHUNK], found = 0;
    for (uint i = begin; i < end; ++i) {
        places[found] = i;
        found += hits[i].primitive != NO_INDEX;
    }
    ChunkLights l = {lights, slots + first_slot, slot_count, first_slot == 0, shadow_rays + chunk * slot_count * CHUNK,
                     {0}};
    uint passing = 0, atomics = 0;
    for (uint first = 0; first < found; first += LANES)
        atomics += shade_lanes(&film, &world, rays + first_ray, hits, places + first, min((uint)LANES, found - first),
                               &l, &passing);

    uint total = 0;
    for (uint k = 0; k < slot_count; ++k) {
        shadow_counts[chunk * slot_count + k] = l.pushed[k];
        total += l.pushed[k];
    }
    atomics += film_count(&counters->shadow_rays, total);
    if (first_slot == 0) {
        film_profile(&film, &counters->missed, end - begin - found);
        film_profile(&film, &counters->passing, passing);
    }
    film_count_atomics(&film, atomics);
}
