// The closest hit, or any: one ray with the infinite planes, and through the eight-wide hierarchy.
// What is found does not depend on the hierarchy: see slabs.h for the boxes, and is_later for ties.
// Source: node layout and octant order, Wald et al., "Getting Rid of Packets", 2008.
#ifndef RAYMILL_TRAVERSE_H
#define RAYMILL_TRAVERSE_H

#include "lib/sphere.h"

// On processors a work-item traces a chunk, so that rays can go together; elsewhere every ray is one.
#ifdef RAYMILL_PACKETS
#define RAYS_A_WORK_ITEM CHUNK
#else
#define RAYS_A_WORK_ITEM 1
#endif

#define STACK_SIZE 256  // seven entries a level, 32 levels, and the root (host/bvh bounds the depth)

/// What rays can hit.
typedef struct {
    global const BvhNode* nodes;
    global const TriangleBlock* triangles;
    global const SphereBlock* spheres;
    global const Plane* planes;
    uint node_count;
    uint plane_count;
    uint first_plane;  // primitive id
} Geometry;

static inline Geometry scene_geometry(global const BvhNode* nodes, global const TriangleBlock* triangles,
                                      global const SphereBlock* spheres, global const Plane* planes,
                                      constant SceneConstants* constants) {
    Geometry g = {nodes,  triangles, spheres, planes, constants->node_count, constants->plane_count,
                  constants->triangle_count + constants->sphere_count};
    return g;
}

/// Eight planes of a node: side 0 lower or 1 upper, of an axis.
static inline float8 planes_of(global const BvhNode* node, uint side, uint axis) {
    return aligned8(node->bounds[side][axis]);
}

/// Children whose boxes the ray meets in [0, t_max], and where it enters them.
static inline uint intersect_children(global const BvhNode* node, SlabFrame f, float t_max, float8* entry) {
    const float8 near_x = fma(planes_of(node, f.sign[0], 0), (float8)(f.inverse.x), (float8)(f.near.x));
    const float8 near_y = fma(planes_of(node, f.sign[1], 1), (float8)(f.inverse.y), (float8)(f.near.y));
    const float8 near_z = fma(planes_of(node, f.sign[2], 2), (float8)(f.inverse.z), (float8)(f.near.z));
    const float8 far_x = fma(planes_of(node, 1 - f.sign[0], 0), (float8)(f.inverse.x), (float8)(f.far.x));
    const float8 far_y = fma(planes_of(node, 1 - f.sign[1], 1), (float8)(f.inverse.y), (float8)(f.far.y));
    const float8 far_z = fma(planes_of(node, 1 - f.sign[2], 2), (float8)(f.inverse.z), (float8)(f.far.z));
    const float8 enter = max8(max8(near_x, near_y), max8(near_z, (float8)(0.0f)));
    const float8 leave = min8(min8(far_x, far_y), min8(far_z, (float8)(t_max)));
    *entry = enter;
    return lane_mask(slabs_overlap(enter, leave));
}

/// Whether a hit comes later along the ray than (t, primitive) in the one order that everybody uses: distance, then id.
static inline bool is_later(float t, uint primitive, float than_t, uint than_primitive) {
    return t > than_t || (t == than_t && primitive > than_primitive);
}

#define ROOT 0u  // the child word of the whole hierarchy

/// Nothing hit up to t_max.
static inline Hit no_hit(float t_max) {
    const Hit hit = {t_max, 0.0f, 0.0f, NO_INDEX};
    return hit;
}

/// A ray, and the hits to look for: later than `after` and not later than `best`, which is replaced.
typedef struct {
    float3 origin;
    float3 direction;
    Hit after;
    Hit best;
} Query;

static inline bool accepts(const Query* query, float t, uint primitive) {
    return is_later(t, primitive, query->after.t, query->after.primitive) &&
           is_later(query->best.t, query->best.primitive, t, primitive);
}

/// Takes the best of a block's hits as the query's if it accepts it. mask: the lanes hit. Whether it did.
static inline bool take_best(Query* query, global const uint* primitives, uint mask, float8 t8, float8 u8, float8 v8) {
    float t[BVH_WIDTH], u[BVH_WIDTH], v[BVH_WIDTH];
    vstore8(t8, 0, t);
    vstore8(u8, 0, u);
    vstore8(v8, 0, v);
    bool taken = false;
    for (; mask != 0; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        const uint primitive = primitives[lane];
        if (!accepts(query, t[lane], primitive)) continue;
        query->best.t = t[lane];
        query->best.u = u[lane];
        query->best.v = v[lane];
        query->best.primitive = primitive;
        taken = true;
    }
    return taken;
}

static inline void visit_triangles(global const TriangleBlock* block, const SlabFrame* slabs, TriangleFrame frame,
                                   Query* query) {
    float8 t, u, v;
    const uint mask = intersect_triangles(block, slabs, frame, query->best.t, &t, &u, &v);
    if (mask != 0) take_best(query, block->primitive, mask, t, u, v);
}

static inline void visit_spheres(global const SphereBlock* block, const SlabFrame* slabs, Query* query) {
    float8 t;
    const uint mask = intersect_spheres(block, slabs, query->origin, query->direction, query->after, query->best.t, &t);
    if (mask != 0) take_best(query, block->primitive, mask, t, (float8)(0.0f), (float8)(0.0f));
}

static inline void visit_leaf(const Geometry* geometry, uint child, const SlabFrame* slabs, const TriangleFrame* frame,
                              Query* query) {
    const uint first = child & CHILD_FIRST_MASK;
    const uint last = first + (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK);
    for (uint block = first; block <= last; ++block) {
        if (child & CHILD_SPHERES)
            visit_spheres(geometry->spheres + block, slabs, query);
        else
            visit_triangles(geometry->triangles + block, slabs, *frame, query);
    }
}

/// Not positive where the plane lies behind, not finite where the ray is parallel to it.
static inline float distance_to_plane(global const Plane* plane, float3 origin, float3 direction) {
    const float3 normal = load3(plane->normal);
    const float height = dot3(normal, origin - load3(plane->point));
    return -height / dot3(normal, direction);
}

static inline void visit_planes(const Geometry* geometry, Query* query) {
    for (uint i = 0; i < geometry->plane_count; ++i) {
        const float t = distance_to_plane(geometry->planes + i, query->origin, query->direction);
        if (!(t > 0.0f && t < INFINITY) || !accepts(query, t, geometry->first_plane + i)) continue;
        query->best.t = t;
        query->best.u = 0.0f;
        query->best.v = 0.0f;
        query->best.primitive = geometry->first_plane + i;
    }
}

/// In the order of distance, farthest first, the places of those of eight lanes that are in the mask. keys: the bits of
/// distances, which are not negative, so that integers sort like floats; the three lowest bits give way to the lane.
static inline uint8 places_by_distance(uint8 keys, uint mask) {
    const uint8 lane = (uint8)(0, 1, 2, 3, 4, 5, 6, 7);
    // Lanes that are not in the mask count as nearer than any, so that their places come last.
    const int8 is_out = ((uint8)(mask) >> lane & 1u) == 0u;
    const int8 key = as_int8(keys & ~7u | lane) | is_out;
    int8 place = key.s12345670 > key;
    place += key.s23456701 > key;
    place += key.s34567012 > key;
    place += key.s45670123 > key;
    place += key.s56701234 > key;
    place += key.s67012345 > key;
    place += key.s70123456 > key;
    return as_uint8(-place);
}

/// Asks for the memory of a child that will be visited soon.
static inline void prefetch_child(const Geometry* geometry, uint child) {
    const uint first = child & CHILD_FIRST_MASK;
    if (!(child & CHILD_LEAF))
        fetch_early(geometry->nodes + child, sizeof(BvhNode));
    else if (child & CHILD_SPHERES)
        fetch_early(geometry->spheres + first, sizeof(SphereBlock));
    else
        fetch_early(geometry->triangles + first, sizeof(TriangleBlock));
}

/// Pushes the children in `mask` so that the nearest is on top. An entry is the distance's bits above the child word.
static inline uint push_children(const Geometry* geometry, global const uint* children, uint mask, float8 entry,
                                 ulong* stack, uint top) {
    uint key[BVH_WIDTH], place[BVH_WIDTH];
    vstore8(as_uint8(entry), 0, key);
    vstore8(places_by_distance(as_uint8(entry), mask), 0, place);
    const uint count = popcount(mask);
    for (; mask != 0; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        stack[top + place[lane]] = (ulong)key[lane] << 32 | children[lane];
        prefetch_child(geometry, children[lane]);
    }
    return top + count;
}

/// Finds the first hit in the query's range among the primitives of the hierarchy; best stays as it is if there is none.
/// With any_hit the first one met will do, whichever it is.
static void traverse(const Geometry* geometry, Query* query, const SlabFrame* slabs, TriangleFrame frame, bool any_hit) {
    const uint none = query->best.primitive;
    if (geometry->node_count == 0) return;
    ulong stack[STACK_SIZE];
    uint top = 0;
    uint child = ROOT;
    for (;;) {
        if (!(child & CHILD_LEAF)) {
            global const BvhNode* node = geometry->nodes + child;
            fetch_early(node->child, sizeof(node->child));  // in a cache line of its own, and needed last
            float8 entry;
            const uint mask = intersect_children(node, *slabs, query->best.t, &entry);
            if ((mask & (mask - 1)) != 0) {
                top = push_children(geometry, node->child, mask, entry, stack, top);
            } else if (mask != 0) {
                child = node->child[lowest_bit(mask)];
                continue;
            }
        } else {
            visit_leaf(geometry, child, slabs, &frame, query);
            if (any_hit && query->best.primitive != none) return;
        }
        ulong item;
        do {
            if (top == 0) return;
            item = stack[--top];
        } while (as_float((uint)(item >> 32)) > query->best.t);
        child = (uint)item;
    }
}

/// traverse() among all primitives, infinite planes included.
static void traverse_all(const Geometry* geometry, Query* query, bool any_hit) {
    visit_planes(geometry, query);
    if (any_hit && query->best.primitive != NO_INDEX) return;
    const SlabFrame slabs = slab_frame(query->origin, query->direction);
    traverse(geometry, query, &slabs, triangle_frame(query->origin, query->direction), any_hit);
}

static inline Hit closest_hit(const Geometry* geometry, float3 origin, float3 direction) {
    Query query = {origin, direction, no_hit(0.0f), no_hit(INFINITY)};
    traverse_all(geometry, &query, false);
    return query.best;
}

/// Some hit up to t_max, whichever is found first; primitive is NO_INDEX if nothing is there.
static inline Hit any_hit_before(const Geometry* geometry, float3 origin, float3 direction, float t_max) {
    Query query = {origin, direction, no_hit(0.0f), no_hit(t_max)};
    traverse_all(geometry, &query, true);
    return query.best;
}

#endif
