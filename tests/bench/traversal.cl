// The traversal of `intersect` and `shadow` without what these do with its result: what Embree's calls do, to measure both
// alike.

#include "lib/trace.h"

/// Reads:  rays.
/// Writes: hits.
kernel void closest(global const Ray* rays, uint count, global const BvhNode* nodes,
                    global const TriangleBlock* triangle_blocks, global const SphereBlock* sphere_blocks,
                    global const Plane* planes, constant SceneConstants* constants, global Hit* hits) {
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const uint begin = get_global_id(0) * RAYS_A_WORK_ITEM;
    if (begin >= count) return;
    find_hits(&geometry, rays + begin, min((uint)RAYS_A_WORK_ITEM, count - begin), hits + begin);
}

/// Reads:  shadow_rays and shadow_counts, segments of CHUNK.
/// Writes: blocked, one byte a place of a segment.
kernel void occlusion(global const ShadowRay* shadow_rays, global const uint* shadow_counts, uint segment_count,
                      global const BvhNode* nodes, global const TriangleBlock* triangle_blocks,
                      global const SphereBlock* sphere_blocks, global const Plane* planes,
                      constant SceneConstants* constants, global uchar* blocked) {
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const uint first = get_global_id(0) * RAYS_A_WORK_ITEM % CHUNK;
    const uint segment = get_global_id(0) * RAYS_A_WORK_ITEM / CHUNK;
    if (segment >= segment_count || first >= shadow_counts[segment]) return;
    const uint count = min((uint)RAYS_A_WORK_ITEM, shadow_counts[segment] - first);
    uint blockers[RAYS_A_WORK_ITEM];
    find_blockers(&geometry, shadow_rays + segment * CHUNK + first, count, blockers);
    for (uint i = 0; i < count; ++i) blocked[segment * CHUNK + first + i] = blockers[i] != NO_INDEX;
}
