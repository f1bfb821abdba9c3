// Local illumination: ambient and emission, and one shadow ray for each light sample that would add something.
// Reads:  rays [first_ray, first_ray + count), hits [0, count), light samples [first_slot, first_slot + slot_count).
// Writes: film (ambient and emission, with slot 0); shadow_rays and shadow_counts, a segment of CHUNK rays for each chunk
//         and light sample, so that a segment's rays go to one light in the order of their pixels; counters->shadow_rays,
//         and with slot 0 missed and passing, where the frame is profiled.
// Next:   shadow.

#include "lib/film.h"
#include "lib/lighting.h"

/// One work-item a chunk of CHUNK hits; segment = chunk * slot_count + slot.
kernel void shade(global const Ray* rays, uint first_ray, uint count, global const Hit* hits, uint first_slot,
                  uint slot_count, global const LightSlot* slots, global const LightRecord* lights,
                  global const Vertex* vertices, global const Triangle* triangles, global const Sphere* spheres,
                  global const Plane* planes, global const Material* materials, global const Texture* textures,
                  global const float* texels, constant SceneConstants* constants, global ShadowRay* shadow_rays,
                  global uint* shadow_counts, global long* film_sums, global Counters* counters, uint film_flags) {
    const Film film = {film_sums, counters, constants, film_flags, ATOMICS_SHADE};
    const World world = {vertices, triangles, spheres, planes, materials, textures, texels, constants};
    const uint chunk = get_global_id(0);
    const uint begin = chunk * CHUNK;
    if (begin >= count) return;
    const uint end = min(begin + CHUNK, count);
    HitLanes lanes = {.count = 0};
    uint pushed[SHADOW_SAMPLES] = {0};
    uint found = 0, passing = 0, adds = 0;

    for (uint i = begin; i < end; ++i) {
        if (hits[i].primitive != NO_INDEX) {
            global const Ray* ray = rays + first_ray + i;
            const Shading shading = shading_at(&world, ray, hits[i]);
            if (first_slot == 0) {
                adds += film_add_two(&film, ray->route, ray->pixel, FILM_AMBIENT, ambient_radiance(&world, &shading),
                                        FILM_EMISSION, emitted_radiance(&shading));
                ++found;
                passing += passes_light_on(shading.material) ? 1u : 0u;
            }
            if (answers_light(&shading)) put_hit(&lanes, &world, &shading);
        }
        if (lanes.count < LANES && (i + 1 < end || lanes.count == 0)) continue;
        for (uint k = 0; k < slot_count; ++k) {
            const LightSlot slot = slots[first_slot + k];
            global ShadowRay* segment = shadow_rays + (chunk * slot_count + k) * CHUNK;
            pushed[k] += push_shadow_rays(&lanes, constants, lights + slot.light, slot, segment + pushed[k]);
        }
        lanes.count = 0;
        lanes.any_blinn = lanes.any_gouraud = false;
    }

    uint total = 0;
    for (uint k = 0; k < slot_count; ++k) {
        shadow_counts[chunk * slot_count + k] = pushed[k];
        total += pushed[k];
    }
    const uint pushes = film_count(&counters->shadow_rays, total);
    if (first_slot == 0) {
        film_profile(&film, &counters->missed, end - begin - found);
        film_profile(&film, &counters->passing, passing);
    }
    film_count_atomics(&film, adds, pushes);
}
