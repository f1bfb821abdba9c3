// The light that gets through the surfaces on its way: a ray's crossings, many of them found in one traversal.
#ifndef RAYMILL_TRANSMITTANCE_H
#define RAYMILL_TRANSMITTANCE_H

#include "lib/surface.h"

#define CROSSINGS 16  // that one traversal finds; a ray that meets more goes again

/// The first crossings in a query's range, in the order of distance and id. `best` is the ray's end, or the last crossing
/// once there are as many as fit: what comes later is out of range.
typedef struct {
    Query query;
    float t[CROSSINGS];
    uint primitive[CROSSINGS];
    uint count;
    bool blocked;  // one lets no light through: nothing else matters
} Crossings;

/// What a primitive in the way leaves of the light: all black if it blocks it.
static inline float3 filter_of(const World* world, uint primitive) {
    if (world->constants->shadows != SHADOWS_FILTERED || !world->constants->any_filter) return (float3)(0.0f);
    global const Material* material = world->materials + material_of(world, primitive);
    return load3(material->base_color) * material->transmission;
}

static inline void add_crossing(Crossings* c, const World* world, float t, uint primitive) {
    if (!accepts(&c->query, t, primitive)) return;
    if (!any(filter_of(world, primitive) != 0.0f)) c->blocked = true;
    uint place = c->count < CROSSINGS ? c->count++ : CROSSINGS - 1;
    for (; place > 0 && is_later(c->t[place - 1], c->primitive[place - 1], t, primitive); --place) {
        c->t[place] = c->t[place - 1];
        c->primitive[place] = c->primitive[place - 1];
    }
    c->t[place] = t;
    c->primitive[place] = primitive;
    if (c->count < CROSSINGS) return;
    c->query.best.t = c->t[CROSSINGS - 1];
    c->query.best.primitive = c->primitive[CROSSINGS - 1];
}

static inline void cross_triangles(Crossings* c, const World* world, global const TriangleBlock* block,
                                   const SlabFrame* slabs, TriangleFrame frame) {
    float8 t8, u8, v8;
    uint mask = intersect_triangles(block, slabs, frame, c->query.best.t, &t8, &u8, &v8);
    if (mask == 0) return;
    float t[BVH_WIDTH];
    vstore8(t8, 0, t);
    for (; mask != 0; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        add_crossing(c, world, t[lane], block->primitive[lane]);
    }
}

/// A sphere is crossed twice: where the ray enters, and after that where it leaves.
static inline void cross_spheres(Crossings* c, const World* world, global const SphereBlock* block,
                                 const SlabFrame* slabs) {
    const float3 origin = c->query.origin, direction = c->query.direction;
    float8 t8;
    uint mask = intersect_spheres(block, slabs, origin, direction, c->query.after, c->query.best.t, &t8);
    if (mask == 0) return;
    float t[BVH_WIDTH], t_exit[BVH_WIDTH];
    vstore8(t8, 0, t);
    for (; mask != 0 && !c->blocked; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        const Hit first = {t[lane], 0.0f, 0.0f, block->primitive[lane]};
        add_crossing(c, world, first.t, first.primitive);
        if (!(intersect_spheres(block, slabs, origin, direction, first, c->query.best.t, &t8) >> lane & 1u)) continue;
        vstore8(t8, 0, t_exit);
        add_crossing(c, world, t_exit[lane], first.primitive);
    }
}

/// Finds the crossings in the query's range, those of infinite planes included. One that blocks ends the search.
static void find_crossings(Crossings* c, const Geometry* geometry, const World* world, const SlabFrame* slabs,
                           TriangleFrame frame) {
    for (uint i = 0; i < geometry->plane_count; ++i) {
        const float t = distance_to_plane(geometry->planes + i, c->query.origin, c->query.direction);
        if (t > 0.0f && t < INFINITY) add_crossing(c, world, t, geometry->first_plane + i);
    }
    if (geometry->node_count == 0) return;
    uint stack[STACK_SIZE];
    uint top = 0;
    stack[top++] = ROOT;
    while (top > 0 && !c->blocked) {
        const uint child = stack[--top];
        if (!(child & CHILD_LEAF)) {
            global const BvhNode* node = geometry->nodes + child;
            float8 entry;
            uint mask = intersect_children(node, *slabs, c->query.best.t, &entry);
            for (; mask != 0; mask &= mask - 1) stack[top++] = node->child[lowest_bit(mask)];
            continue;
        }
        const uint first = child & CHILD_FIRST_MASK;
        const uint last = first + (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK);
        for (uint block = first; block <= last; ++block) {
            if (child & CHILD_SPHERES)
                cross_spheres(c, world, geometry->spheres + block, slabs);
            else
                cross_triangles(c, world, geometry->triangles + block, slabs, frame);
        }
    }
}

/// What is left of light from t_max away: filtered by every transmissive surface on the way, each crossing once.
COMPILED_ONCE static float3 transmittance(const Geometry* geometry, const World* world, float3 origin, float3 direction,
                                   float t_max) {
    const SlabFrame slabs = slab_frame(origin, direction);
    const TriangleFrame frame = triangle_frame(origin, direction);
    Crossings c;
    c.query.origin = origin;
    c.query.direction = direction;
    c.query.after = no_hit(0.0f);
    c.blocked = false;
    float3 left = (float3)(1.0f);
    for (;;) {
        c.query.best = no_hit(t_max);
        c.count = 0;
        find_crossings(&c, geometry, world, &slabs, frame);
        if (c.blocked) return (float3)(0.0f);
        // In the order of distance, so that the product's bits do not depend on the hierarchy.
        for (uint i = 0; i < c.count; ++i) left *= filter_of(world, c.primitive[i]);
        if (c.count < CROSSINGS || !any(left != 0.0f)) return left;
        c.query.after = c.query.best;
    }
}

#endif
