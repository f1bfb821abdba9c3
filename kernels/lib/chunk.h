// A chunk of rays as structure of arrays, with the frames that slabs.h and triangle.h give each ray alone: the same
// arithmetic, sixteen rays at a time.
#ifndef RAYMILL_CHUNK_H
#define RAYMILL_CHUNK_H

#include "lib/gather.h"
#include "lib/traverse.h"

#define GROUP 16                // rays of one vector
#define GROUPS (CHUNK / GROUP)  // vectors of a chunk

// Bits of RayChunk::octant: the largest axis of the direction, and from OCTANT_SIGN on the sign of each axis.
#define OCTANT_AXIS 3u
#define OCTANT_SIGN 2u

// Bytes of the next chunk asked for while one is loaded, and by each visit. Multiples of cache lines.
#define ASKED_FIRST 1024
#define ASKED_A_VISIT 512

/// Up to CHUNK rays: ray i is lane i % GROUP of vector i / GROUP. Places without a ray repeat one, with best_t = -1, which
/// no distance is below: what is tested finds nothing for them.
typedef struct {
    float16 origin[3][GROUPS], direction[3][GROUPS];
    float16 inverse[3][GROUPS], near[3][GROUPS], far[3][GROUPS];  // SlabFrame
    float16 shear[3][GROUPS];                                     // TriangleFrame: x, y, z
    float16 best_t[GROUPS], best_u[GROUPS], best_v[GROUPS];
    uint16 best_primitive[GROUPS];
    uint16 octant[GROUPS];
    ulong rays;  // one bit each
    global const uchar *unasked, *unasked_end;  // memory of the next chunk
} RayChunk;

static inline float get_lane(const float16* vectors, uint i) { return ((const float*)vectors)[i]; }
static inline void set_lane(float16* vectors, uint i, float value) { ((float*)vectors)[i] = value; }

/// Ray i's vector of three, given along each axis.
static inline float3 get_vector(const float16 (*axes)[GROUPS], uint i) {
    return (float3)(get_lane(axes[0], i), get_lane(axes[1], i), get_lane(axes[2], i));
}

static inline uint get_octant(const RayChunk* c, uint i) { return ((const uint*)c->octant)[i]; }

/// Asks for a part of the rays that the next work-item will load: a chunk fills a page, and processors do not foresee beyond
/// that. Not for all at once, which would wait until a core's few places for memory on its way are free again.
static inline void chunk_ask_ahead(RayChunk* c, uint bytes) {
    global const uchar* from = c->unasked;
    if (from >= c->unasked_end) return;
    fetch_early(from, bytes);
    c->unasked = from + bytes;
}

/// What ray i has found.
static inline Hit chunk_hit(const RayChunk* c, uint i) {
    const Hit hit = {get_lane(c->best_t, i), get_lane(c->best_u, i), get_lane(c->best_v, i),
                     ((const uint*)c->best_primitive)[i]};
    return hit;
}

static inline void chunk_set_hit(RayChunk* c, uint i, Hit hit) {
    set_lane(c->best_t, i, hit.t);
    set_lane(c->best_u, i, hit.u);
    set_lane(c->best_v, i, hit.v);
    ((uint*)c->best_primitive)[i] = hit.primitive;
}

/// Ray i of a search for any hits is done: this stands in its way.
static inline void chunk_set_blocker(RayChunk* c, uint i, uint primitive) {
    set_lane(c->best_t, i, -1.0f);
    ((uint*)c->best_primitive)[i] = primitive;
}

/// slab_frame() of a group on one axis.
static inline void prepare_slabs(RayChunk* c, uint group, uint axis) {
    const float16 direction = c->direction[axis][group];
    const int16 parallel = fabs(direction) < 1e-24f;
    const float16 d = select(direction, copysign((float16)(1e-24f), direction), parallel);
    const float16 inverse = 1.0f / d;
    const float16 offset = -c->origin[axis][group] * inverse;
    const float16 rounding = fabs(offset) * (3.0f * ROUNDING);
    const float16 error = select(rounding, max16(rounding, (float16)(1e12f)), parallel);
    c->inverse[axis][group] = inverse;
    c->near[axis][group] = offset - error;
    c->far[axis][group] = offset + error;
    c->octant[group] |= as_uint16(d) >> 31 << (OCTANT_SIGN + axis);
}

/// triangle_frame() of a group that has its slab frame, whose reciprocal of the largest axis is the frame's too.
static inline void prepare_triangle_frame(RayChunk* c, uint group) {
    const float16 x = c->direction[0][group], y = c->direction[1][group], z = c->direction[2][group];
    const int16 z_over_x = fabs(z) >= fabs(x), z_over_y = fabs(z) >= fabs(y);
    const int16 is_x = (fabs(x) > fabs(y)) & ~z_over_x, is_y = ~(fabs(x) > fabs(y)) & ~z_over_y;
    c->octant[group] |= as_uint16(select(select((int16)(2), (int16)(1), is_y), (int16)(0), is_x));
    const float16 inverse =
        select(select(c->inverse[2][group], c->inverse[1][group], is_y), c->inverse[0][group], is_x);
    const float16 next = select(select(x, z, is_y), y, is_x);
    const float16 last = select(select(y, x, is_y), z, is_x);
    const int16 swap = inverse < 0.0f;
    c->shear[0][group] = select(next, last, swap) * inverse;
    c->shear[1][group] = select(last, next, swap) * inverse;
    c->shear[2][group] = inverse;
}

/// slab_frame() and triangle_frame() of all rays.
static inline void chunk_frames(RayChunk* c) {
    for (uint group = 0; group < GROUPS; ++group) {
        c->octant[group] = (uint16)(0);
#pragma unroll
        for (uint axis = 0; axis < 3; ++axis) prepare_slabs(c, group, axis);
        prepare_triangle_frame(c, group);
    }
}

/// The lanes of a group whose rays have a bit set.
static inline int16 lanes_of_rays(ulong rays, uint group) {
    const uint16 bit = (uint16)(0x1, 0x2, 0x4, 0x8, 0x10, 0x20, 0x40, 0x80, 0x100, 0x200, 0x400, 0x800, 0x1000, 0x2000,
                                0x4000, 0x8000);
    return ((uint16)((uint)(rays >> GROUP * group)) & bit) != 0u;
}

/// The rays of one octant, one bit each; and those whose directions have the same signs, whichever axis is their largest.
static inline ulong rays_of_octant(const RayChunk* c, uint octant) {
    ulong rays = 0;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group)
        rays |= (ulong)lane_mask16(c->octant[group] == octant) << (GROUP * group);
    return rays & c->rays;
}
static inline ulong rays_of_signs(const RayChunk* c, uint octant) {
    ulong rays = 0;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group)
        rays |= (ulong)lane_mask16((c->octant[group] ^ octant) >> OCTANT_SIGN == 0u) << (GROUP * group);
    return rays & c->rays;
}

/// Those rays of a search for any hits that are done.
static inline ulong chunk_done(const RayChunk* c) {
    ulong done = 0;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group) done |= (ulong)lane_mask16(c->best_t[group] < 0.0f) << GROUP * group;
    return done;
}

/// Those rays that have found a primitive.
static inline ulong chunk_found(const RayChunk* c) {
    ulong found = 0;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group)
        found |= (ulong)lane_mask16(c->best_primitive[group] != NO_INDEX) << GROUP * group;
    return found;
}

/// The first ray in the lanes that are left out.
static inline float16 repeat_first(const float16* vectors, uint group, uint first, int16 is_in) {
    return select((float16)(get_lane(vectors, first)), vectors[group], is_in);
}

/// Those rays of a chunk that have a bit set, at least one and all of one octant, as a chunk: each stays in its place.
static inline void chunk_part(RayChunk* part, const RayChunk* c, ulong rays) {
    const uint first = lowest_bit64(rays);
    part->rays = rays;
    part->unasked = c->unasked;
    part->unasked_end = c->unasked_end;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group) {
        const int16 is_in = lanes_of_rays(rays, group);
#pragma unroll
        for (uint axis = 0; axis < 3; ++axis) {
            part->origin[axis][group] = repeat_first(c->origin[axis], group, first, is_in);
            part->direction[axis][group] = repeat_first(c->direction[axis], group, first, is_in);
            part->inverse[axis][group] = repeat_first(c->inverse[axis], group, first, is_in);
            part->near[axis][group] = repeat_first(c->near[axis], group, first, is_in);
            part->far[axis][group] = repeat_first(c->far[axis], group, first, is_in);
            part->shear[axis][group] = repeat_first(c->shear[axis], group, first, is_in);
        }
        part->best_t[group] = select((float16)(-1.0f), c->best_t[group], is_in);
        part->best_u[group] = c->best_u[group];
        part->best_v[group] = c->best_v[group];
        part->best_primitive[group] = c->best_primitive[group];
        part->octant[group] = (uint16)(get_octant(c, first));
    }
}

/// Takes over what a part has found, and asked for.
static inline void chunk_merge(RayChunk* c, const RayChunk* part) {
    c->unasked = part->unasked;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group) {
        const int16 is_in = lanes_of_rays(part->rays, group);
        c->best_t[group] = select(c->best_t[group], part->best_t[group], is_in);
        c->best_u[group] = select(c->best_u[group], part->best_u[group], is_in);
        c->best_v[group] = select(c->best_v[group], part->best_v[group], is_in);
        c->best_primitive[group] = select(c->best_primitive[group], part->best_primitive[group], is_in);
    }
}

/// Loads `count` rays of a queue, count > 0, and makes their frames. A record, `stride` words long, begins with the
/// origin in words 0-2 and the direction in 4-6. With have_end word 3 says how far away hits count.
static inline void chunk_load(RayChunk* c, global const void* records, uint stride, bool have_end, uint count) {
    const uint16 lane = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    global const float* words = records;
    c->rays = ~0ul >> (CHUNK - count);
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group) {
        const uint16 place = lane + GROUP * group;
        const int16 is_ray = place < count;
        Lanes4 start, along;
        if (GROUP * (group + 1) <= count) {
            start = load4(words + GROUP * group * stride, stride);
            along = load4(words + GROUP * group * stride + 4, stride);
        } else {
            const uint16 record = select((uint16)(0), place, is_ray);
            start = gather4(words, stride, record);
            along = gather4(words + 4, stride, record);
        }
        c->origin[0][group] = start.x;
        c->origin[1][group] = start.y;
        c->origin[2][group] = start.z;
        c->direction[0][group] = along.x;
        c->direction[1][group] = along.y;
        c->direction[2][group] = along.z;
        c->best_t[group] = select((float16)(-1.0f), have_end ? start.w : (float16)(INFINITY), is_ray);
        c->best_u[group] = (float16)(0.0f);
        c->best_v[group] = (float16)(0.0f);
        c->best_primitive[group] = (uint16)(NO_INDEX);
    }
    c->unasked = (global const uchar*)(words + CHUNK * stride);
    c->unasked_end = (global const uchar*)(words + 2 * CHUNK * stride);
    chunk_ask_ahead(c, ASKED_FIRST);
    chunk_frames(c);
}

/// Writes what the first `count` rays have found.
static inline void chunk_store_hits(const RayChunk* c, uint count, global Hit* hits) {
    for (uint group = 0; group < GROUPS; ++group) {
        const Lanes3 tuv = {c->best_t[group], c->best_u[group], c->best_v[group]};
        const Rows rows = rows_of(tuv, as_float16(c->best_primitive[group]));
        if (GROUP * (group + 1) <= count) {
#pragma unroll
            for (uint part = 0; part < 4; ++part) vstore16(rows.part[part], 4 * group + part, (global float*)hits);
        } else {
            for (uint i = GROUP * group; i < count; ++i) store_row(hits + i, row_of(&rows, i - GROUP * group));
        }
    }
}

/// visit_planes() of all rays.
static inline void chunk_visit_planes(RayChunk* c, const Geometry* geometry) {
    for (uint i = 0; i < geometry->plane_count; ++i) {
        const float3 normal = load3(geometry->planes[i].normal), point = load3(geometry->planes[i].point);
        const uint primitive = geometry->first_plane + i;
        for (uint group = 0; group < GROUPS; ++group) {
            const float16 x = c->origin[0][group] - point.x, y = c->origin[1][group] - point.y;
            const float16 z = c->origin[2][group] - point.z;
            const float16 height = fma((float16)(normal.x), x, fma((float16)(normal.y), y, normal.z * z));
            const float16 approach = fma((float16)(normal.x), c->direction[0][group],
                                         fma((float16)(normal.y), c->direction[1][group],
                                             normal.z * c->direction[2][group]));
            const float16 t = -height / approach, best_t = c->best_t[group];
            const int16 hit = (t > 0.0f) & (t < INFINITY) &
                              ((t < best_t) | ((t == best_t) & (primitive < c->best_primitive[group])));
            c->best_t[group] = select(best_t, t, hit);
            c->best_primitive[group] = select(c->best_primitive[group], (uint16)(primitive), hit);
        }
    }
}

/// What ray i looks for: something nearer than its best hit so far.
static inline Query chunk_query(const RayChunk* c, uint i) {
    Query query;
    query.origin = get_vector(c->origin, i);
    query.direction = get_vector(c->direction, i);
    query.after = no_hit(0.0f);
    query.best = chunk_hit(c, i);
    return query;
}

/// slab_frame() of ray i.
static inline SlabFrame chunk_slabs(const RayChunk* c, uint i) {
    SlabFrame f;
    f.inverse = get_vector(c->inverse, i);
    f.near = get_vector(c->near, i);
    f.far = get_vector(c->far, i);
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) f.sign[axis] = get_octant(c, i) >> (OCTANT_SIGN + axis) & 1u;
    return f;
}

/// The axes of the triangle frames of an octant.
static inline TriangleFrame octant_axes(uint octant) {
    const uint largest = octant & OCTANT_AXIS;
    return frame_axes(largest, (octant >> (OCTANT_SIGN + largest) & 1u) != 0);
}

/// triangle_frame() of ray i, whose axes these are.
static inline TriangleFrame chunk_triangle_frame(const RayChunk* c, uint i, TriangleFrame axes) {
    TriangleFrame f = axes;
    f.origin_x = get_lane(c->origin[f.x], i);
    f.origin_y = get_lane(c->origin[f.y], i);
    f.origin_z = get_lane(c->origin[f.z], i);
    f.shear_x = get_lane(c->shear[0], i);
    f.shear_y = get_lane(c->shear[1], i);
    f.shear_z = get_lane(c->shear[2], i);
    return f;
}

#endif
