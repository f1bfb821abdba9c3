// Beams: what sixteen coherent rays have in common, and which boxes and triangles they may meet, eight at a time.
// What a beam leaves out no ray of it can hit; what it lets through is tested ray by ray.
// Sources: Overbeck, Ramamoorthi, Mark, "Large Ray Packets for Real-time Whitted Ray Tracing", 2008 (frusta of packets);
// Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 2007.
#ifndef RAYMILL_BEAM_H
#define RAYMILL_BEAM_H

#include "lib/chunk.h"

#define PAIRS (GROUPS / 2)
#define ALL_GROUPS ((1u << GROUPS) - 1u)

/// Coherent rays: their largest axes and the signs of their directions are the same, which the arithmetic relies on.
/// The rays of a group lie in a beam. Along their largest axis z its depth is (z - waist) * side, not negative where the
/// rays are; across it, on the axes x and y of the triangle frame, at every depth
///     -bound[0] - slope[0] * depth <= x <= bound[1] + slope[1] * depth.
/// The waist is where the rays come closest: the eye, its mirror image, a lamp; beams widen from there.
/// A vector holds two groups, eight lanes each, for eight boxes or triangles.
typedef struct {
    RayChunk rays;
    float16 slope[2][2][PAIRS], bound[2][2][PAIRS];  // lower and upper, x and y
    float16 enter_scale[PAIRS], enter_offset[PAIRS];  // z * scale + offset: no later than any ray can be there
    float16 leave_scale[PAIRS], leave_offset[PAIRS];  // no earlier
    float16 farthest[PAIRS];                          // largest best_t
    float farthest_of_all;
    float waist, side;
    uint axis[3];  // of the triangle frame: x, y, z
    uint sign[3];  // of the slab frame
    bool is_pinhole;  // all rays start at one point: beams tell nearly as much as rays
} Packet;

// Halves of vectors are taken through pointers and lanes are named one by one: Oclgrind 21.10 reads beyond its record of
// what was written for v.hi, v.s1032547698badcfe and (float16)(v, v).

/// The smallest and the largest lane.
static inline float min_lane(float16 v) {
    const float8* half16 = (const float8*)&v;
    const float8 v8 = min8(half16[0], half16[1]);
    const float4* half8 = (const float4*)&v8;
    const float4 v4 = select(half8[1], half8[0], half8[0] < half8[1]);
    const float2* half4 = (const float2*)&v4;
    const float2 v2 = select(half4[1], half4[0], half4[0] < half4[1]);
    return v2.x < v2.y ? v2.x : v2.y;
}

static inline float max_lane(float16 v) { return -min_lane(-v); }

static inline float16 twice(float8 v) {
    float16 pair;
    float8* half16 = (float8*)&pair;
    half16[0] = v;
    half16[1] = v;
    return pair;
}

/// The first eight lanes of two vectors, and the last eight.
static inline float16 first_halves(float16 a, float16 b) {
    return (float16)(a.s0, a.s1, a.s2, a.s3, a.s4, a.s5, a.s6, a.s7, b.s0, b.s1, b.s2, b.s3, b.s4, b.s5, b.s6, b.s7);
}
static inline float16 last_halves(float16 a, float16 b) {
    return (float16)(a.s8, a.s9, a.sa, a.sb, a.sc, a.sd, a.se, a.sf, b.s8, b.s9, b.sa, b.sb, b.sc, b.sd, b.se, b.sf);
}

/// The smallest lane of each of four vectors, in four lanes each: half of two vectors at a time.
static inline float16 min_lanes(float16 a, float16 b, float16 c, float16 d) {
    const float16 ab = min16(first_halves(a, b), last_halves(a, b)), cd = min16(first_halves(c, d), last_halves(c, d));
    const float16 q = min16((float16)(ab.s0, ab.s1, ab.s2, ab.s3, ab.s8, ab.s9, ab.sa, ab.sb, cd.s0, cd.s1, cd.s2,
                                      cd.s3, cd.s8, cd.s9, cd.sa, cd.sb),
                            (float16)(ab.s4, ab.s5, ab.s6, ab.s7, ab.sc, ab.sd, ab.se, ab.sf, cd.s4, cd.s5, cd.s6,
                                      cd.s7, cd.sc, cd.sd, cd.se, cd.sf));
    const float16 e = min16(q, (float16)(q.s2, q.s3, q.s0, q.s1, q.s6, q.s7, q.s4, q.s5, q.sa, q.sb, q.s8, q.s9, q.se,
                                         q.sf, q.sc, q.sd));
    return min16(e, (float16)(e.s1, e.s0, e.s3, e.s2, e.s5, e.s4, e.s7, e.s6, e.s9, e.s8, e.sb, e.sa, e.sd, e.sc, e.sf,
                              e.se));
}

/// The smallest and the largest lane of each group, in four lanes each.
static inline float16 min_of_groups(const float16* v) {
    return min_lanes(v[0], v[1], v[2], v[3]);
}
static inline float16 max_of_groups(const float16* v) {
    return -min_lanes(-v[0], -v[1], -v[2], -v[3]);
}

/// Spreads such lanes to the eight that a group has in a vector of pairs.
static inline void set_pairs(float16* pairs, float16 v) {
    pairs[0] = (float16)(v.s0, v.s0, v.s0, v.s0, v.s0, v.s0, v.s0, v.s0, v.s4, v.s4, v.s4, v.s4, v.s4, v.s4, v.s4,
                         v.s4);
    pairs[1] = (float16)(v.s8, v.s8, v.s8, v.s8, v.s8, v.s8, v.s8, v.s8, v.sc, v.sc, v.sc, v.sc, v.sc, v.sc, v.sc,
                         v.sc);
}

static inline void update_farthest(Packet* p) {
    const float16 farthest = max_of_groups(p->rays.best_t);
    set_pairs(p->farthest, farthest);
    p->farthest_of_all = fmax(fmax(farthest.s0, farthest.s4), fmax(farthest.s8, farthest.sc));
}

/// Where along z the first and the last ray reach a plane. A single ray's distances are up to 5 roundings of
/// origin * inverse away from the middle (slabs.h), ours 3 more.
static inline void prepare_depth(Packet* p) {
    const uint z = p->axis[2], sign = p->sign[z];
    const float16 lower = min_of_groups(p->rays.origin[z]), upper = max_of_groups(p->rays.origin[z]);
    const float16 smallest = min_of_groups(p->rays.inverse[z]), largest = max_of_groups(p->rays.inverse[z]);
    const float16 slack = 16.0f * ROUNDING * max16(fabs(lower), fabs(upper));
    const float16 slow = sign ? largest : smallest, fast = sign ? smallest : largest;  // smaller and larger |inverse|
    set_pairs(p->enter_scale, slow);
    set_pairs(p->enter_offset, -(sign ? lower : upper) * slow - slack * fabs(slow));
    set_pairs(p->leave_scale, fast);
    set_pairs(p->leave_offset, -(sign ? upper : lower) * fast + slack * fabs(fast));
}

/// Widened by more than what the tests of single rays may be off: a few roundings of the origins, the waist and what lies
/// between for the bound, of the depth for the slope (slopes are at most 1).
static inline void prepare_beams(Packet* p) {
    float16 size = (float16)(0.0f);
    for (uint group = 0; group < GROUPS; ++group) {
        const float16 to_waist = fabs(p->waist - p->rays.origin[p->axis[2]][group]);
        size = max16(to_waist + fabs(p->rays.origin[p->axis[0]][group]), size);
        size = max16(to_waist + fabs(p->rays.origin[p->axis[1]][group]), size);
    }
    const float slack = 32.0f * ROUNDING * (max_lane(size) + fabs(p->waist));
    for (uint a = 0; a < 2; ++a) {
        float16 rising[GROUPS], place[GROUPS];
        for (uint group = 0; group < GROUPS; ++group) {
            const float16 slope = p->rays.shear[a][group];
            place[group] = fma(slope, p->waist - p->rays.origin[p->axis[2]][group], p->rays.origin[p->axis[a]][group]);
            rising[group] = slope * p->side;
        }
        set_pairs(p->slope[0][a], 32.0f * ROUNDING - min_of_groups(rising));
        set_pairs(p->slope[1][a], 32.0f * ROUNDING + max_of_groups(rising));
        set_pairs(p->bound[0][a], slack - min_of_groups(place));
        set_pairs(p->bound[1][a], slack + max_of_groups(place));
    }
}

/// How wide the packet is where its rays reach a plane square to z.
static inline float width_at(const Packet* p, float z) {
    float16 lower[2], below_upper[2];
#pragma unroll
    for (uint a = 0; a < 2; ++a) {
        float16 lo = (float16)(INFINITY), hi = (float16)(-INFINITY);
        for (uint group = 0; group < GROUPS; ++group) {
            const float16 place = fma(p->rays.shear[a][group], z - p->rays.origin[p->axis[2]][group],
                                      p->rays.origin[p->axis[a]][group]);
            lo = min16(lo, place);
            hi = max16(hi, place);
        }
        lower[a] = lo;
        below_upper[a] = -hi;
    }
    const float16 m = min_lanes(lower[0], below_upper[0], lower[1], below_upper[1]);
    return -(m.s0 + m.s4) - (m.s8 + m.sc);
}

/// Where along z the first and the last ray come closest; not finite if they are parallel.
static inline float crossing(const Packet* p) {
    const RayChunk* c = &p->rays;
    const uint z = p->axis[2], first = lowest_bit64(c->rays), last = 63u - (uint)clz(c->rays);
    const float slope_x = get_lane(c->shear[0], last) - get_lane(c->shear[0], first);
    const float slope_y = get_lane(c->shear[1], last) - get_lane(c->shear[1], first);
    const uint a = fabs(slope_x) > fabs(slope_y) ? 0 : 1;
    const float origin_z = get_lane(c->origin[z], first);
    const float apart_z = get_lane(c->origin[z], last) - origin_z;
    const float apart = get_lane(c->origin[p->axis[a]], last) - get_lane(c->origin[p->axis[a]], first);
    return origin_z + (get_lane(c->shear[a], last) * apart_z - apart) / (a == 0 ? slope_x : slope_y);
}

/// Finds the waist: where the packet is narrowest of where its rays start, end, or seem to come from or go to beyond
/// these. In between it will not do: a beam that converged and widened again would not be one.
static inline void find_waist(Packet* p) {
    const RayChunk* c = &p->rays;
    const uint z = p->axis[2];
    const float travel = p->sign[z] ? -1.0f : 1.0f;
    p->waist = c->origin[z][0].s0;
    p->side = travel;
    if (p->is_pinhole) return;
    float16 start16 = (float16)(INFINITY), end16 = (float16)(-INFINITY);
    for (uint group = 0; group < GROUPS; ++group) {
        const float16 start = c->origin[z][group] * travel;
        start16 = min16(start, start16);
        end16 = max16(fma(fabs(c->direction[z][group]), max16(c->best_t[group], (float16)(0.0f)), start), end16);
    }
    const float start = min_lane(start16), end = max_lane(end16);
    p->waist = start * travel;
    float width = width_at(p, p->waist);
    if (end < INFINITY) {
        const float width_at_end = width_at(p, end * travel);
        if (width_at_end < width) {
            width = width_at_end;
            p->waist = end * travel;
            p->side = -travel;
        }
    }
    const float apex = crossing(p) * travel;
    if ((apex < start || (apex > end)) && fabs(apex - start) < 1e4f * width) {
        if (width_at(p, apex * travel) < width) {
            p->waist = apex * travel;
            p->side = apex < start ? travel : -travel;
        }
    }
}

/// Whether all rays start at one point.
static inline bool have_one_origin(const RayChunk* c) {
    int16 other = (int16)(0);
    for (uint axis = 0; axis < 3; ++axis)
        for (uint group = 0; group < GROUPS; ++group) other |= c->origin[axis][group] != c->origin[axis][0].s0;
    return !any16(other);
}

/// Makes a packet of its coherent rays.
static inline void packet_prepare(Packet* p) {
    const uint octant = p->rays.octant[0].s0;
    for (uint axis = 0; axis < 3; ++axis) p->sign[axis] = octant >> (OCTANT_SIGN + axis) & 1u;
    const TriangleFrame frame = frame_axes(octant & OCTANT_AXIS, p->sign[octant & OCTANT_AXIS] != 0);
    p->axis[0] = frame.x;
    p->axis[1] = frame.y;
    p->axis[2] = frame.z;
    p->is_pinhole = have_one_origin(&p->rays);
    find_waist(p);
    prepare_depth(p);
    prepare_beams(p);
    update_farthest(p);
}

/// Which of eight boxes some ray of each group may meet, bit 8 * group + box, and where the first ray can enter them.
/// A box lies outside a beam if all its corners lie on the far side of one of the beam's planes.
static inline uint groups_meeting_children(const Packet* p, global const BvhNode* node, float8* entry) {
    const uint z = p->axis[2];
    const float16 enter_z = twice(aligned8(node->bounds[p->sign[z]][z]));
    const float16 leave_z = twice(aligned8(node->bounds[1 - p->sign[z]][z]));
    const float16 depth0 = (enter_z - p->waist) * p->side, depth1 = (leave_z - p->waist) * p->side;
    const float16 lower_x = twice(aligned8(node->bounds[0][p->axis[0]]));
    const float16 upper_x = twice(aligned8(node->bounds[1][p->axis[0]]));
    const float16 lower_y = twice(aligned8(node->bounds[0][p->axis[1]]));
    const float16 upper_y = twice(aligned8(node->bounds[1][p->axis[1]]));
    uint mask = 0;
    float16 soonest = (float16)(INFINITY);
#pragma unroll
    for (uint pair = 0; pair < PAIRS; ++pair) {
        const float16 k0 = p->bound[0][0][pair] + upper_x, k1 = p->bound[0][1][pair] + upper_y;
        const float16 k2 = p->bound[1][0][pair] - lower_x, k3 = p->bound[1][1][pair] - lower_y;
        const float16 s0 = p->slope[0][0][pair], s1 = p->slope[0][1][pair];
        const float16 s2 = p->slope[1][0][pair], s3 = p->slope[1][1][pair];
        const float16 inside = min16(min16(max16(fma(s0, depth0, k0), fma(s0, depth1, k0)),
                                           max16(fma(s1, depth0, k1), fma(s1, depth1, k1))),
                                     min16(max16(fma(s2, depth0, k2), fma(s2, depth1, k2)),
                                           max16(fma(s3, depth0, k3), fma(s3, depth1, k3))));
        const float16 enter = max16(fma(enter_z, p->enter_scale[pair], p->enter_offset[pair]), (float16)(0.0f)) *
                              (1.0f - 4.0f * ROUNDING);
        const float16 leave = fma(leave_z, p->leave_scale[pair], p->leave_offset[pair]);
        const int16 meets = (min16(inside, leave) >= 0.0f) & (enter <= p->farthest[pair]);
        mask |= lane_mask16(meets) << (2 * BVH_WIDTH * pair);
        soonest = min16(enter, soonest);
    }
    const float8* of_pair = (const float8*)&soonest;
    *entry = min8(of_pair[0], of_pair[1]);
    return mask;
}

/// The same for triangles: all three corners on the far side of a plane.
static inline uint groups_meeting_triangles(const Packet* p, global const TriangleBlock* block) {
    float16 x[3], y[3], depth[3];
    const uint z = p->axis[2];
#pragma unroll
    for (uint corner = 0; corner < 3; ++corner) {
        x[corner] = twice(aligned8(block->position[corner][p->axis[0]]));
        y[corner] = twice(aligned8(block->position[corner][p->axis[1]]));
        depth[corner] = twice((aligned8(block->position[corner][z]) - p->waist) * p->side);
    }
    uint mask = 0;
#pragma unroll
    for (uint pair = 0; pair < PAIRS; ++pair) {
        const float16 s0 = p->slope[0][0][pair], s1 = p->slope[0][1][pair];
        const float16 s2 = p->slope[1][0][pair], s3 = p->slope[1][1][pair];
        const float16 in0 = max16(max16(fma(s0, depth[0], x[0]), fma(s0, depth[1], x[1])), fma(s0, depth[2], x[2]));
        const float16 in1 = max16(max16(fma(s1, depth[0], y[0]), fma(s1, depth[1], y[1])), fma(s1, depth[2], y[2]));
        const float16 in2 = max16(max16(fma(s2, depth[0], -x[0]), fma(s2, depth[1], -x[1])), fma(s2, depth[2], -x[2]));
        const float16 in3 = max16(max16(fma(s3, depth[0], -y[0]), fma(s3, depth[1], -y[1])), fma(s3, depth[2], -y[2]));
        const float16 inside = min16(min16(in0 + p->bound[0][0][pair], in1 + p->bound[0][1][pair]),
                                     min16(in2 + p->bound[1][0][pair], in3 + p->bound[1][1][pair]));
        mask |= lane_mask16((inside >= 0.0f) & (p->farthest[pair] >= 0.0f)) << (2 * BVH_WIDTH * pair);
    }
    return mask;
}

/// Which rays of the group meet child `lane`.
static inline uint rays_meeting(const Packet* p, global const BvhNode* node, uint lane, uint group) {
    float16 enter = (float16)(0.0f), leave = p->rays.best_t[group];
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 inverse = p->rays.inverse[axis][group];
        const float near = node->bounds[p->sign[axis]][axis][lane], far = node->bounds[1 - p->sign[axis]][axis][lane];
        enter = max16(fma((float16)(near), inverse, p->rays.near[axis][group]), enter);
        leave = min16(fma((float16)(far), inverse, p->rays.far[axis][group]), leave);
    }
    return lane_mask16(enter <= leave * (1.0f + 8.0f * ROUNDING));
}

/// One bit a group in the lowest four, spread to all boxes of such a mask; and the groups that meet one box.
static inline uint spread_groups(uint groups) { return (groups * 0x00204081u & 0x01010101u) * 0xffu; }
static inline uint groups_of_box(uint mask, uint box) {
    return (mask >> box & 0x01010101u) * 0x01020408u >> 24 & ALL_GROUPS;
}

#endif
