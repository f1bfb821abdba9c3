// How the rays of a batch go on, for the profile.
// Reads:  hits [0, count).
// Writes: counters->missed and passing.
// Next:   nothing; it runs beside shade, where a frame is profiled.

#include "lib/surface.h"

/// One work-item a chunk of CHUNK hits.
kernel void tally(global const Hit* hits, uint count, global const Triangle* triangles, global const Sphere* spheres,
                  global const Plane* planes, global const Material* materials, constant SceneConstants* constants,
                  global Counters* counters) {
    const World world = {0, triangles, spheres, planes, materials, 0, 0, constants};
    const uint begin = get_global_id(0) * CHUNK;
    const uint end = min(begin + CHUNK, count);
    uint missed = 0, passing = 0;
    for (uint i = begin; i < end; ++i) {
        const uint primitive = hits[i].primitive;
        missed += primitive == NO_INDEX;
        passing += may_spawn(&world, primitive);
    }
    if (missed != 0) atom_add(&counters->missed, (ulong)missed);
    if (passing != 0) atom_add(&counters->passing, (ulong)passing);
}
