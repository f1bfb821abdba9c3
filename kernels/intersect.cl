// The closest hit of every ray of a batch; rays that miss bring home the background.
// Reads:  rays [first_ray, first_ray + count).
// Writes: hits [0, count); film, where a ray misses; counters->children, which `secondary` of the same wave counts from
//         0.
// Next:   shade.

#include "lib/environment.h"
#include "lib/film.h"
#include "lib/surface.h"
#include "lib/trace.h"

/// What those rays of a chunk bring home that miss everything, up to sixteen, named by `place`.
COMPILED_ONCE static uint add_background(const Film* film, global const Texture* textures, global const float* texels,
                                         global const Ray* rays, global const Hit* hits, const uint* place,
                                         uint count) {
    const HitLanes lanes = gather_hits(rays, hits, place, count);
    const Lanes3 sky = environment_radiance(textures, texels, film->constants, lanes.direction);
    Terms terms = {.lanes = first_lanes(count), .second = {{(float16)(0.0f)}}};
    vstore16(lanes.pixel, 0, terms.pixel);
    vstore16(lanes.route, 0, terms.route);
    terms.first = rows_of(lanes_mul(lanes.throughput, sky), (float16)(0.0f));
    return film_add_terms(film, FILM_EMISSION, FILM_EMISSION, &terms);
}

/// One work-item a chunk of CHUNK rays, or one ray where rays are traced alone.
kernel void intersect(global const Ray* rays, uint first_ray, uint count, global const BvhNode* nodes,
                      global const TriangleBlock* triangle_blocks, global const SphereBlock* sphere_blocks,
                      global const Plane* planes, global const Texture* textures, global const float* texels,
                      constant SceneConstants* constants, global Hit* hits, global long* film_sums,
                      global Counters* counters, uint film_flags) {
    const Film film = {film_sums, counters, constants, film_flags, ATOMICS_INTERSECT};
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const uint begin = get_global_id(0) * RAYS_A_WORK_ITEM;
    const uint end = min(begin + RAYS_A_WORK_ITEM, count);
    if (begin >= count) return;
    if (begin == 0) counters->children = 0;
    ulong missing = find_hits(&geometry, rays + first_ray + begin, end - begin, hits + begin);
    uint misses[RAYS_A_WORK_ITEM], missed = 0, atomics = 0;
    for (; missing != 0; missing &= missing - 1) misses[missed++] = begin + lowest_bit64(missing);
    for (uint first = 0; first < missed; first += LANES)
        atomics += add_background(&film, textures, texels, rays + first_ray, hits, misses + first,
                                  min((uint)LANES, missed - first));
    film_count_atomics(&film, atomics);
}
