// The closest hit of every ray of a batch; rays that miss bring home the background.
// Reads:  rays [first_ray, first_ray + count).
// Writes: hits [0, count); film, where a ray misses.
// Next:   shade.

#include "lib/environment.h"
#include "lib/film.h"
#include "lib/packet.h"

/// Closest hits of a chunk of coherent rays, together; false, and nothing done, if they are better traced one by one.
static bool intersect_together(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
#ifdef RAYMILL_PACKETS
    Packet packet;
    float3 origins[CHUNK], directions[CHUNK];
    for (uint i = 0; i < count; ++i) {
        origins[i] = load3(rays[i].origin);
        directions[i] = load3(rays[i].direction);
    }
    if (!are_coherent(directions, count)) return false;
    packet_start(&packet);
    for (uint i = 0; i < count; ++i) {
        packet_add(&packet, origins[i], directions[i], closest_plane(geometry, origins[i], directions[i], INFINITY));
    }
    packet_fill(&packet);
    traverse_packet(geometry, &packet, false, origins, directions);
    for (uint i = 0; i < count; ++i) hits[i] = packet_hit(&packet, i);
    return true;
#else
    return false;
#endif
}

/// One work-item a chunk of CHUNK rays.
kernel void intersect(global const Ray* rays, uint first_ray, uint count, global const BvhNode* nodes,
                      global const TriangleBlock* triangle_blocks, global const SphereBlock* sphere_blocks,
                      global const Plane* planes, global const Texture* textures, global const float* texels,
                      constant SceneConstants* constants, global Hit* hits, global long* film_sums,
                      global Counters* counters, uint pixels_once) {
    const Film film = {film_sums, counters, constants, pixels_once != 0};
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const uint begin = get_global_id(0) * CHUNK;
    const uint end = min(begin + CHUNK, count);
    if (begin >= count) return;
    if (!intersect_together(&geometry, rays + first_ray + begin, end - begin, hits + begin))
        for (uint i = begin; i < end; ++i) {
            global const Ray* ray = rays + first_ray + i;
            hits[i] = closest_hit(&geometry, load3(ray->origin), load3(ray->direction));
        }
    for (uint i = begin; i < end; ++i) {
        global const Ray* ray = rays + first_ray + i;
        if (hits[i].primitive != NO_INDEX) {
            if (ray->route == ROUTE_CAMERA)
                film_add_units(&film, film_pixel(&film, FILM_BEAUTY, ray->pixel) + 3, FILM_ONE);
        } else {
            const float3 sky = environment_radiance(textures, texels, constants, load3(ray->direction));
            film_add_radiance(&film, FILM_EMISSION, ray->route, ray->pixel, load3(ray->throughput) * sky);
        }
    }
}
