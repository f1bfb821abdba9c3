// What the rays of a queue meet: a chunk of them together on processors, one ray elsewhere.
#ifndef RAYMILL_TRACE_H
#define RAYMILL_TRACE_H

#include "lib/packet.h"

#ifdef RAYMILL_PACKETS
/// Finds the closest hit of each ray. Returns the rays that miss, one bit each.
COMPILED_ONCE static ulong find_hits(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    Packet packet;
    chunk_load(&packet.rays, rays, WORDS(Ray), false, count);
    traverse_chunk(geometry, &packet, false);
    chunk_store_hits(&packet.rays, count, hits);
    return packet.rays.rays & ~chunk_found(&packet.rays);
}

/// Returns the shadow rays that are blocked, one bit each. blockers, of RAYS_A_WORK_ITEM places, gets some primitive
/// that blocks each ray, or NO_INDEX.
COMPILED_ONCE static ulong find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count,
                                         uint* blockers) {
    Packet packet;
    chunk_load(&packet.rays, rays, WORDS(ShadowRay), true, count);
    traverse_chunk(geometry, &packet, true);
    for (uint group = 0; group < GROUPS; ++group) vstore16(packet.rays.best_primitive[group], group, blockers);
    return chunk_found(&packet.rays);
}
#else
static ulong find_hits(const Geometry* geometry, global const Ray* rays, uint count, global Hit* hits) {
    ulong missed = 0;
    for (uint i = 0; i < count; ++i) {
        const Hit hit = closest_hit(geometry, load3(rays[i].origin), load3(rays[i].direction));
        missed |= (ulong)(hit.primitive == NO_INDEX) << i;
        hits[i] = hit;
    }
    return missed;
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
