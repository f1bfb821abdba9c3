// What stands in the way of shadow rays.
#ifndef RAYMILL_BLOCKERS_H
#define RAYMILL_BLOCKERS_H

#include "lib/packet.h"

/// For each of a segment's shadow rays some primitive that stands in its way, or NO_INDEX.
#ifdef RAYMILL_PACKETS
static void find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count, uint* blockers) {
    Packet packet;
    chunk_load(&packet.rays, rays, WORDS(ShadowRay), true, count);
    traverse_chunk(geometry, &packet, true);
    for (uint group = 0; group < GROUPS; ++group) vstore16(packet.rays.best_primitive[group], group, blockers);
}
#else
static void find_blockers(const Geometry* geometry, global const ShadowRay* rays, uint count, uint* blockers) {
    for (uint i = 0; i < count; ++i)
        blockers[i] = any_hit_before(geometry, load3(rays[i].origin), load3(rays[i].direction), rays[i].t_max).primitive;
}
#endif

#endif
