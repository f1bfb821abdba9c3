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

/// Returns the shadow rays that are blocked, one bit each. blockers, of RAYS_A_WORK_ITEM places, gets some primitive
/// that blocks each ray, or NO_INDEX.
COMPILED_ONCE static ulong find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count,
                                         uint* blockers) {
    Packet packet;
    chunk_load(&packet.rays, rays, WORDS(ShadowRay), true, count);
    traverse_chunk(geometry, &packet, true);
    ulong blocked = 0;
    for (uint group = 0; group < GROUPS; ++group) {
        const uint16 primitive = packet.rays.best_primitive[group];
        blocked |= (ulong)lane_mask16(primitive != NO_INDEX) << GROUP * group;
        vstore16(primitive, group, blockers);
    }
    return blocked;
}
#else
static void find_hits(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    for (uint i = 0; i < count; ++i) hits[i] = closest_hit(geometry, load3(rays[i].origin), load3(rays[i].direction));
}

static ulong find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count, uint* blockers) {
    ulong blocked = 0;
    for (uint i = 0; i < count; ++i) {
        blockers[i] = any_hit_before(geometry, load3(rays[i].origin), load3(rays[i].direction), rays[i].t_max).primitive;
        blocked |= (ulong)(blockers[i] != NO_INDEX) << i;
    }
    return blocked;
}
#endif

#endif
