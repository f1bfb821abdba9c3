// What the rays of a queue meet: a chunk of them together on processors, one ray elsewhere.
#ifndef RAYMILL_TRACE_H
#define RAYMILL_TRACE_H

#include "lib/packet.h"

#ifdef RAYMILL_PACKETS
/// The closest hit of each ray.
COMPILED_ONCE static void find_hits(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    Packet packet;
    chunk_load(&packet.rays, rays, WORDS(Ray), false, count);
    traverse_chunk(geometry, &packet, false);
    chunk_store_hits(&packet.rays, count, hits);
}

/// For each shadow ray some primitive that stands in its way, or NO_INDEX. blockers has RAYS_A_WORK_ITEM places.
COMPILED_ONCE static void find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count,
                                        uint* blockers) {
    Packet packet;
    chunk_load(&packet.rays, rays, WORDS(ShadowRay), true, count);
    traverse_chunk(geometry, &packet, true);
    for (uint group = 0; group < GROUPS; ++group) vstore16(packet.rays.best_primitive[group], group, blockers);
}
#else
static void find_hits(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    for (uint i = 0; i < count; ++i) hits[i] = closest_hit(geometry, load3(rays[i].origin), load3(rays[i].direction));
}

static void find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count, uint* blockers) {
    for (uint i = 0; i < count; ++i)
        blockers[i] = any_hit_before(geometry, load3(rays[i].origin), load3(rays[i].direction), rays[i].t_max).primitive;
}
#endif

#endif
