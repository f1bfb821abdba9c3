// Rays of a chunk that go their own ways to their closest hits, several in flight: while the memory that one asks for is on
// its way, the others take their steps. What a ray finds is what traverse() finds for it.
// The processor runs ahead of what it waits for, as far as it can foresee branches; so a step has few that depend on data.
#ifndef RAYMILL_FLIGHT_H
#define RAYMILL_FLIGHT_H

#include "lib/chunk.h"

#define FLIGHT 16  // rays: with 8 a twelfth slower where the hierarchy exceeds the caches, with 32 no faster

/// A ray on its way through the hierarchy.
typedef struct {
    Query query;
    SlabFrame slabs;
    TriangleFrame frame;
    uint ray;                 // its place in the chunk
    uint child;               // what it visits next
    uint top;                 // of the stack
    ulong stack[STACK_SIZE];  // entries are those of push_children()
} Flight;

/// Where the memory of a child lies, by the two highest bits of its word.
typedef struct {
    ulong first[4];
    uint stride[4];
} ChildMemory;

static inline ChildMemory child_memory(const Geometry* geometry) {
    const ulong nodes = (ulong)geometry->nodes;
    const ChildMemory m = {{nodes, nodes, (ulong)geometry->triangles, (ulong)geometry->spheres},
                           {sizeof(BvhNode), sizeof(BvhNode), sizeof(TriangleBlock), sizeof(SphereBlock)}};
    return m;
}

/// prefetch_child() without branches.
static inline void prefetch_next(const ChildMemory* memory, uint child) {
    const uint kind = child >> 30;
    const ulong address = memory->first[kind] + (ulong)(child & CHILD_FIRST_MASK) * memory->stride[kind];
    fetch_early((global const void*)address, sizeof(TriangleBlock));  // the largest
}

/// push_children() without branches for up to two children, which most nodes have no more of.
static inline uint push_few(const Geometry* geometry, global const uint* children, uint mask, float8 entry,
                            ulong* stack, uint top) {
    const uint count = popcount(mask);
    if (count > 2) return push_children(geometry, children, mask, entry, stack, top);
    uint key[BVH_WIDTH];
    vstore8(as_uint8(entry), 0, key);
    // One child is both the first and the last. None is any lane, pushed but not counted.
    const uint first = lowest_bit(mask | 0x80u), last = 31u - clz(mask | 1u);
    const ulong a = (ulong)key[first] << 32 | children[first], b = (ulong)key[last] << 32 | children[last];
    stack[top] = max(a, b);
    stack[top + 1] = min(a, b);
    return top + count;
}

static inline void take_off(Flight* f, const RayChunk* c, uint ray) {
    f->query = chunk_query(c, ray);
    f->slabs = chunk_slabs(c, ray);
    f->frame = chunk_triangle_frame(c, ray, octant_axes(get_octant(c, ray)));
    f->ray = ray;
    f->child = ROOT;
    f->top = 0;
}

/// Visits one node or leaf, and asks for the next. False if there is none.
static inline bool fly_on(Flight* f, const Geometry* geometry, const ChildMemory* memory) {
    const uint child = f->child;
    uint top = f->top;
    if (!(child & CHILD_LEAF)) {
        global const BvhNode* node = geometry->nodes + child;
        float8 entry;
        const uint mask = intersect_children(node, f->slabs, f->query.best.t, &entry);
        top = push_few(geometry, node->child, mask, entry, f->stack, top);
    } else {
        visit_leaf(geometry, child, &f->slabs, &f->frame, &f->query);
    }
    ulong item;
    do {
        if (top == 0) return false;
        item = f->stack[--top];
    } while (as_float((uint)(item >> 32)) > f->query.best.t);
    f->child = (uint)item;
    f->top = top;
    prefetch_next(memory, f->child);
    return true;
}

/// Finds the closest hits of those rays of a chunk that have a bit set, from their best hits so far.
static void fly_rays(const Geometry* scene, RayChunk* c, ulong rays) {
    const Geometry geometry = *scene;  // a copy that no store can change, for the compiler to keep in registers
    const ChildMemory memory = child_memory(scene);
    Flight flights[FLIGHT];
    uchar active[FLIGHT];  // in the first places, flights that are not over
    uint count = 0;
    for (; rays != 0 && count < FLIGHT; rays &= rays - 1) {
        active[count] = count;
        take_off(flights + count++, c, lowest_bit64(rays));
    }
    while (count > 0) {
        for (uint i = 0; i < count; ++i) {
            Flight* f = flights + active[i];
            if (fly_on(f, &geometry, &memory)) continue;
            chunk_set_hit(c, f->ray, f->query.best);
            if (rays != 0) {
                take_off(f, c, lowest_bit64(rays));
                rays &= rays - 1;
            } else {
                active[i--] = active[--count];
            }
        }
    }
}

#endif
