// The closest hit of every ray of a batch; rays that miss bring home the background.
// Reads:  rays [first_ray, first_ray + count).
// Writes: hits [0, count); film, where a ray misses.
// Next:   shade.

#include "lib/environment.h"
#include "lib/traverse.h"
#include "lib/film.h"

/// One work-item a chunk of CHUNK rays.
kernel void intersect(global const Ray* rays, uint first_ray, uint count, global const BvhNode* nodes,
                      global const TriangleBlock* triangle_blocks, global const SphereBlock* sphere_blocks,
                      global const Plane* planes, global const Texture* textures, global const float* texels,
                      constant SceneConstants* constants, global Hit* hits, global long* film_sums,
                      global Counters* counters) {
    const Film film = {film_sums, counters, constants};
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const uint begin = get_global_id(0) * CHUNK;
    const uint end = min(begin + CHUNK, count);
    for (uint i = begin; i < end; ++i) {
        global const Ray* ray = rays + first_ray + i;
        const float3 direction = load3(ray->direction);
        const Hit hit = closest_hit(&geometry, load3(ray->origin), direction);
        hits[i] = hit;
        if (hit.primitive != NO_INDEX) {
            if (ray->route == ROUTE_CAMERA)
                film_add_units(&film, film_pixel(&film, FILM_BEAUTY, ray->pixel) + 3, FILM_ONE);
        } else {
            const float3 sky = environment_radiance(textures, texels, constants, direction);
            film_add_radiance(&film, FILM_EMISSION, ray->route, ray->pixel, load3(ray->throughput) * sky);
        }
    }
}
