// Rays of a chunk that visit the hierarchy together but are tested one by one, each against eight boxes or triangles: for
// rays too few or too far apart to be a packet. The memory of a visit, the wait for it and the choice of what comes next
// serve all rays that share it. What a ray finds is what traverse() finds for it.
// Source: Tsakok, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", High Performance Graphics 2009.
// Deviations: masks of at most 64 rays instead of lists, and memory asked for ahead.
#ifndef RAYMILL_STREAM_H
#define RAYMILL_STREAM_H

#include "lib/flight.h"

// Visits whose memory is asked for before their turn. Closest hits lose by visits chosen early what hits found meanwhile would
// have culled; of any hits, no order is better than another.
#define AHEAD_FOR_CLOSEST 2
#define AHEAD_FOR_ANY 8  // a power of two, and no less than the other, nor than what a stream begins with (packet.h)

#define STREAMS 8  // of a chunk: as many as combinations of signs

// Where this many entries are on the stack, no more than one visit is chosen ahead: once those that had been are made, each
// of which may push the children of a node, the stack grows as that of a ray alone, by STACK_SIZE at most.
#define STREAM_FULL 512
#define STREAM_STACK (STREAM_FULL + BVH_WIDTH * AHEAD_FOR_ANY + STACK_SIZE)

#define FEWEST_VISITS 128  // before it is judged how many rays share one

/// A child, and the rays that meet it, one bit each.
typedef struct {
    uint child;
    ulong rays;
} Visit;

/// Rays whose directions have the same signs, on their way through the hierarchy.
typedef struct {
    uint sign[3];  // as in SlabFrame
    uint top;      // of the stack
    Visit* stack;
} Stream;

/// How many rays share a visit.
typedef struct {
    uint visits;
    uint rays;
} Sharing;

/// Whether they are so few that each had better choose its own order: thin triangles, whose boxes overlap everywhere.
static inline bool share_little(const Sharing* s) { return s->visits > FEWEST_VISITS && 4 * s->rays < 7 * s->visits; }

static inline void count_visit(Sharing* s, ulong rays) {
    s->visits += 1;
    s->rays += popcount(rays);
}

/// Pushes the children that some ray meets; for closest hits so that the one that is met soonest is on top. Without branches
/// for up to two, as push_few() in flight.h.
static inline void stream_push(Stream* s, global const uint* children, const ulong* rays, uint mask, float8 soonest,
                               bool any_hit) {
    const uint top = s->top, count = popcount(mask);
    s->top = top + count;
    if (count > 2) {
        uint place[BVH_WIDTH];
        if (!any_hit) vstore8(places_by_distance(as_uint8(soonest), mask), 0, place);
        for (uint i = 0; mask != 0; ++i, mask &= mask - 1) {
            const uint lane = lowest_bit(mask), to = top + (any_hit ? i : place[lane]);
            s->stack[to].child = children[lane];
            s->stack[to].rays = rays[lane];
        }
        return;
    }
    uint key[BVH_WIDTH];
    vstore8(as_uint8(soonest), 0, key);
    const uint first = lowest_bit(mask | 0x80u), last = 31u - clz(mask | 1u);
    const uint near = any_hit || key[first] < key[last] ? first : last, far = first ^ last ^ near;
    s->stack[top].child = children[far];
    s->stack[top].rays = rays[far];
    s->stack[top + 1].child = children[near];
    s->stack[top + 1].rays = rays[near];
}

/// intersect_children() for each ray of some, at least one, and what they meet pushed.
static inline void stream_visit_node(Stream* s, const RayChunk* c, global const BvhNode* node, ulong rays, bool any_hit) {
    const float8 near_x = planes_of(node, s->sign[0], 0), far_x = planes_of(node, 1 - s->sign[0], 0);
    const float8 near_y = planes_of(node, s->sign[1], 1), far_y = planes_of(node, 1 - s->sign[1], 1);
    const float8 near_z = planes_of(node, s->sign[2], 2), far_z = planes_of(node, 1 - s->sign[2], 2);
    long8 meeting = (long8)(0);  // for each child, one bit a ray
    float8 soonest = (float8)(INFINITY);
    do {
        const uint ray = lowest_bit64(rays);
        const SlabFrame f = chunk_slabs(c, ray);
        const float8 enter_x = fma(near_x, (float8)(f.inverse.x), (float8)(f.near.x));
        const float8 enter_y = fma(near_y, (float8)(f.inverse.y), (float8)(f.near.y));
        const float8 enter_z = fma(near_z, (float8)(f.inverse.z), (float8)(f.near.z));
        const float8 leave_x = fma(far_x, (float8)(f.inverse.x), (float8)(f.far.x));
        const float8 leave_y = fma(far_y, (float8)(f.inverse.y), (float8)(f.far.y));
        const float8 leave_z = fma(far_z, (float8)(f.inverse.z), (float8)(f.far.z));
        const float8 enter = max8(max8(enter_x, enter_y), max8(enter_z, (float8)(0.0f)));
        const float8 leave = min8(min8(leave_x, leave_y), min8(leave_z, (float8)(get_lane(c->best_t, ray))));
        const int8 meets = slabs_overlap(enter, leave);
        meeting |= convert_long8(meets) & (long8)(rays & -rays);
        if (!any_hit) soonest = select(soonest, min8(enter, soonest), meets);
        rays &= rays - 1;
    } while (rays != 0);
    ulong of_child[BVH_WIDTH];
    vstore8(as_ulong8(meeting), 0, of_child);
    stream_push(s, node->child, of_child, lane_mask(convert_int8(meeting != 0)), soonest, any_hit);
}

/// Takes the best of a block's hits as that of a ray, or any of them as its blocker; whether it did. mask: the lanes hit,
/// at least one.
static inline bool stream_take(RayChunk* c, uint ray, global const uint* primitives, uint mask, float8 t, float8 u, float8 v,
                               bool any_hit) {
    if (any_hit) {
        chunk_set_blocker(c, ray, primitives[lowest_bit(mask)]);
        return true;
    }
    Query query = chunk_query(c, ray);
    if (!take_best(&query, primitives, mask, t, u, v)) return false;
    chunk_set_hit(c, ray, query.best);
    return true;
}

/// Tests rays against a block of triangles; those that have found something new. one_frame: they share octant_axes().
static inline ulong stream_visit_triangles(RayChunk* c, global const TriangleBlock* block, ulong rays, bool one_frame,
                                           bool any_hit) {
    const TriangleFrame axes = octant_axes(get_octant(c, lowest_bit64(rays)));
    ulong found = 0;
    for (; rays != 0; rays &= rays - 1) {
        const uint ray = lowest_bit64(rays);
        const TriangleFrame frame = chunk_triangle_frame(c, ray, one_frame ? axes : octant_axes(get_octant(c, ray)));
        const SlabFrame slabs = chunk_slabs(c, ray);
        float8 t, u, v;
        const uint mask = intersect_triangles(block, &slabs, frame, get_lane(c->best_t, ray), &t, &u, &v);
        if (mask == 0) continue;
        if (stream_take(c, ray, block->primitive, mask, t, u, v, any_hit)) found |= rays & -rays;
    }
    return found;
}

/// The same for a block of spheres.
static __attribute__((noinline)) ulong stream_visit_spheres(RayChunk* c, global const SphereBlock* block, ulong rays,
                                                            bool any_hit) {
    ulong found = 0;
    for (; rays != 0; rays &= rays - 1) {
        const uint ray = lowest_bit64(rays);
        const SlabFrame slabs = chunk_slabs(c, ray);
        float8 t;
        const uint mask = intersect_spheres(block, &slabs, get_vector(c->origin, ray), get_vector(c->direction, ray),
                                            no_hit(0.0f), get_lane(c->best_t, ray), &t);
        if (mask == 0) continue;
        const float8 zero = (float8)(0.0f);
        if (stream_take(c, ray, block->primitive, mask, t, zero, zero, any_hit)) found |= rays & -rays;
    }
    return found;
}

/// visit_leaf() for each ray of some; those that have found something new.
static inline ulong stream_visit_leaf(RayChunk* c, const Geometry* geometry, uint child, ulong rays, bool one_frame,
                                      bool any_hit) {
    const uint first = child & CHILD_FIRST_MASK;
    const uint last = first + (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK);
    ulong found = 0;
    for (uint block = first; block <= last; ++block) {
        const ulong left = any_hit ? rays & ~found : rays;
        if (left == 0) break;
        found |= child & CHILD_SPHERES
                     ? stream_visit_spheres(c, geometry->spheres + block, left, any_hit)
                     : stream_visit_triangles(c, geometry->triangles + block, left, one_frame, any_hit);
    }
    return found;
}

/// Makes a visit. With any_hit, the rays that are done by it; else those that have found something new.
static inline ulong stream_visit(Stream* s, RayChunk* c, const Geometry* geometry, Visit visit, bool one_frame,
                                 bool any_hit) {
    if (visit.child & CHILD_LEAF) return stream_visit_leaf(c, geometry, visit.child, visit.rays, one_frame, any_hit);
    stream_visit_node(s, c, geometry->nodes + visit.child, visit.rays, any_hit);
    return 0;
}

/// Takes the next visit of rays that are not done from the stack, and asks for its memory. False if there is none.
static inline bool stream_next(Stream* s, const ChildMemory* memory, ulong done, Visit* next) {
    uint top = s->top;
    do {
        if (top == 0) return false;
        next->rays = s->stack[--top].rays & ~done;
    } while (next->rays == 0);
    s->top = top;
    next->child = s->stack[top].child;
    prefetch_next(memory, next->child);
    return true;
}

static inline void stream_begin(Stream* s, const RayChunk* c, ulong rays, Visit* stack) {
    const uint octant = get_octant(c, lowest_bit64(rays));
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) s->sign[axis] = octant >> (OCTANT_SIGN + axis) & 1u;
    s->top = 0;
    s->stack = stack;
}

/// Makes some visits and all below them, by rays of one octant, from their best hits so far. ahead: the visits, and room for
/// AHEAD_FOR_ANY. Whether a ray has found something new. Closest hits may be left unfound if rays share_little(); not so
/// any hits.
static bool stream_below(const Geometry* scene, RayChunk* c, Visit* ahead, uint count, bool any_hit, Sharing* sharing) {
    const Geometry geometry = *scene;  // a copy that no store can change, for the compiler to keep in registers
    const ChildMemory memory = child_memory(scene);
    const uint most = any_hit ? AHEAD_FOR_ANY : AHEAD_FOR_CLOSEST;
    Visit stack[STREAM_STACK];
    Stream stream;
    stream_begin(&stream, c, ahead[0].rays, stack);
    uint first = 0;  // of a ring
    const ulong done = any_hit ? chunk_done(c) : 0;
    ulong found = done;
    while (count > 0) {
        Visit visit = ahead[first % AHEAD_FOR_ANY];
        first += 1;
        count -= 1;
        if (any_hit) {
            visit.rays &= ~found;
        } else {
            count_visit(sharing, visit.rays);
            if (share_little(sharing)) break;
        }
        chunk_ask_ahead(c, ASKED_A_VISIT);
        if (visit.rays != 0) found |= stream_visit(&stream, c, &geometry, visit, true, any_hit);
        while (count < (stream.top < STREAM_FULL ? most : 1) &&
               stream_next(&stream, &memory, any_hit ? found : 0, ahead + (first + count) % AHEAD_FOR_ANY))
            count += 1;
    }
    return found != done;
}

/// Finds whether some rays of a chunk hit anything.
static void stream_any_hits(const Geometry* geometry, RayChunk* c, ulong rays) {
    Sharing sharing = {0, 0};
    while (rays != 0) {
        const ulong members = rays & rays_of_octant(c, get_octant(c, lowest_bit64(rays)));
        Visit all[AHEAD_FOR_ANY] = {{ROOT, members}};
        stream_below(geometry, c, all, 1, true, &sharing);
        rays &= ~members;
    }
}

/// Finds the closest hits of some rays of a chunk, several streams in flight: while the memory that one asks for is on its
/// way, the others make their visits. Rays of a stream need not have the same largest axis: more of them share a visit.
static void stream_closest_hits(const Geometry* scene, RayChunk* c, ulong rays) {
    const Geometry geometry = *scene;
    const ChildMemory memory = child_memory(scene);
    Visit stacks[STREAMS][STACK_SIZE];
    Stream streams[STREAMS];
    Visit visits[STREAMS];
    uchar active[STREAMS];  // in the first places, streams that are not over
    uint count = 0;
    for (ulong waiting = rays; waiting != 0; waiting &= ~visits[count++].rays) {
        visits[count].child = ROOT;
        visits[count].rays = waiting & rays_of_signs(c, get_octant(c, lowest_bit64(waiting)));
        active[count] = count;
        stream_begin(streams + count, c, visits[count].rays, stacks[count]);
    }
    Sharing sharing = {0, 0};
    while (count > 0) {
        for (uint i = 0; i < count; ++i) {
            Stream* s = streams + active[i];
            Visit* visit = visits + active[i];
            count_visit(&sharing, visit->rays);
            chunk_ask_ahead(c, ASKED_A_VISIT);
            stream_visit(s, c, &geometry, *visit, false, false);
            if (!stream_next(s, &memory, 0, visit)) active[i--] = active[--count];
        }
        if (count > 0 && share_little(&sharing)) {
            fly_rays(scene, c, rays);
            return;
        }
    }
}

#endif
