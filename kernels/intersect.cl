// The closest hit of every ray of a batch; rays that miss bring home the background.
// Reads:  rays [first_ray, first_ray + count).
// Writes: hits [0, count); film, where a ray misses.
// Next:   shade.

#include "lib/environment.h"
#include "lib/film.h"
#include "lib/packet.h"

#ifdef RAYMILL_PACKETS
static void intersect_chunk(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    Packet packet;
    for (uint i = 0; i < count; ++i) chunk_add(&packet.rays, i, rays[i].origin, rays[i].direction, INFINITY);
    chunk_prepare(&packet.rays, count);
    traverse_chunk(geometry, &packet, false);
    for (uint i = 0; i < count; ++i) hits[i] = chunk_hit(&packet.rays, i);
}
#else
static void intersect_chunk(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    for (uint i = 0; i < count; ++i) hits[i] = closest_hit(geometry, load3(rays[i].origin), load3(rays[i].direction));
}
#endif

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
    intersect_chunk(&geometry, rays + first_ray + begin, end - begin, hits + begin);
    uint adds = 0;
    for (uint i = begin; i < end; ++i) {
        global const Ray* ray = rays + first_ray + i;
        if (hits[i].primitive != NO_INDEX) {
            if (ray->route == ROUTE_CAMERA)
                adds += film_add_units(&film, film_pixel(&film, FILM_BEAUTY, ray->pixel) + 3, FILM_ONE);
        } else {
            const float3 sky = environment_radiance(textures, texels, constants, load3(ray->direction));
            adds += film_add_radiance(&film, FILM_EMISSION, ray->route, ray->pixel, load3(ray->throughput) * sky);
        }
    }
    film_count_atomics(&film, adds, 0);
}
