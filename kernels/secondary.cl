// Reflected and refracted rays of a batch's hits.
// Reads:  rays [first_ray, first_ray + count), hits [0, count).
// Writes: children, up to `capacity` from first_child on; counters->children, and parents where the frame is profiled.
// Next:   intersect, one level deeper.

#include "lib/material.h"
#include "lib/random.h"

#ifdef RAYMILL_PACKETS
#define PARENTS_A_WORK_ITEM FAMILY
#else
#define PARENTS_A_WORK_ITEM CHUNK
#endif

/// One branch of up to sixteen hits: the child of each lane in `mask`.
typedef struct {
    uint mask;
    Rows origin, direction, throughput;  // and pixel, sample, path
    uint16 route;
} ChildLanes;

/// share: of the light that the branch brings. side: -1 where the child leaves on the other side of the surface.
static inline void spawn(const World* world, const HitLanes* hits, const SurfaceLanes* s, Lanes3 weight, float16 share,
                         Lanes3 direction, float side, uint branch, ChildLanes* c) {
    const Lanes3 throughput = lanes_scale(weight, share);
    const int16 counts = lanes_max(throughput) >= world->constants->min_weight;
    c->mask = lane_mask16(counts & lanes_any(throughput)) & first_lanes(hits->count);
    if (c->mask == 0) return;
    c->origin = rows_of(leave_surfaces(world, s, side), as_float16(hits->pixel));
    c->direction = rows_of(direction, as_float16(hits->sample));
    c->throughput = rows_of(throughput, as_float16(path_child(hits->path, branch)));
    const uint16 first_branch = (uint16)(branch == 0 ? ROUTE_REFLECTED : ROUTE_REFRACTED);
    c->route = select(hits->route, first_branch, hits->route == ROUTE_CAMERA);
}

/// The children of up to sixteen hits: reflected rays, and refracted ones.
COMPILED_ONCE static void spawn_children(const World* world, const HitLanes* hits, ChildLanes* reflected,
                                  ChildLanes* refracted) {
    SurfaceLanes s;
    surfaces_at(world, hits, &s);
    const Split split = split_rays(world, &s, hits->direction);
    const Lanes3 throughput = absorbed(world, &s, material_flags(world, &s), hits->throughput, hits->t);
    const Lanes3 weight = lanes_mul(throughput, lanes_xyz(material4(world, &s, world->materials->base_color)));
    spawn(world, hits, &s, weight, split.reflection, split.reflected, 1.0f, 0, reflected);
    spawn(world, hits, &s, weight, split.transmission, split.refracted, -1.0f, 1, refracted);
}

/// Writes one branch's children, the first to `place`; returns the place behind them.
COMPILED_ONCE static ulong write_children(const ChildLanes* branch, uint groups, global Ray* children, ulong place) {
    for (uint group = 0; group < groups; ++group) {
        const ChildLanes* c = branch + group;
        for (uint rest = c->mask; rest != 0; rest &= rest - 1) {
            const uint lane = lowest_bit(rest);
            global Ray* child = children + place++;
            store_row(child->origin, row_of(&c->origin, lane));
            store_row(child->direction, row_of(&c->direction, lane));
            store_row(child->throughput, row_of(&c->throughput, lane));
            child->route = ((const uint*)&c->route)[lane];
        }
    }
    return place;
}

/// The hits of a launch, and where their children go.
typedef struct {
    global const Ray* rays;
    global const Hit* hits;
    global Ray* children;
    ulong capacity;
    global Counters* counters;
    bool counted;
} Parents;

/// Counts the children of hits [begin, end), takes their places with one atomic add and writes them: the reflected rays
/// first, so that a chunk of the next level has more rays that went the same way, there and on all levels before.
COMPILED_ONCE static void spawn_family(const World* world, const Parents* p, uint begin, uint end) {
    uint places[PARENTS_A_WORK_ITEM], found = 0;
    for (uint i = begin; i < end; ++i)
        if (may_spawn(world, p->hits[i].primitive)) places[found++] = i;

    ChildLanes reflected[PARENTS_A_WORK_ITEM / LANES], refracted[PARENTS_A_WORK_ITEM / LANES];
    uint spawned = 0, parents = 0, groups = 0;
    for (uint first = 0; first < found; first += LANES, ++groups) {
        const HitLanes lanes = gather_hits(p->rays, p->hits, places + first, min((uint)LANES, found - first));
        spawn_children(world, &lanes, reflected + groups, refracted + groups);
        spawned += popcount(reflected[groups].mask) + popcount(refracted[groups].mask);
        parents += popcount(reflected[groups].mask | refracted[groups].mask);
    }
    if (spawned == 0) return;

    if (p->counted) {
        atom_add(&p->counters->parents, (ulong)parents);
        atom_inc(&p->counters->atomics[ATOMICS_SECONDARY]);  // the one below
    }
    const ulong place = atom_add(&p->counters->children, (ulong)spawned);
    if (place + spawned > p->capacity) return;  // the host sees the count and stops
    write_children(refracted, groups, p->children, write_children(reflected, groups, p->children, place));
}

/// A work-item owns PARENTS_A_WORK_ITEM hits.
kernel void secondary(global const Ray* rays, uint first_ray, uint count, global const Hit* hits,
                      global const Vertex* vertices, global const Triangle* triangles, global const Sphere* spheres,
                      global const Plane* planes, global const Material* materials, global const Texture* textures,
                      global const float* texels, constant SceneConstants* constants, global Ray* children,
                      uint first_child, uint capacity, global Counters* counters, uint counted) {
    const World world = {vertices, triangles, spheres, planes, materials, textures, texels, constants};
    const Parents all = {rays + first_ray, hits, children + first_child, capacity, counters, counted != 0};
    const uint begin = get_global_id(0) * PARENTS_A_WORK_ITEM;
    if (begin < count) spawn_family(&world, &all, begin, min(begin + PARENTS_A_WORK_ITEM, count));
}
