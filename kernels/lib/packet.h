// A chunk of coherent rays through the hierarchy together: one visit of a node or triangle serves all of them.
// What each ray finds is the same to the last bit as alone: the arithmetic of each test is that of traverse.h, triangle.h
// and sphere.h, sixteen rays against one primitive instead of one ray against eight, and which hit wins does not depend on
// the order.
// Sources: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 2007
// (interval tests); Overbeck, Ramamoorthi, Mark, "Large Ray Packets for Real-time Whitted Ray Tracing", 2008.
#ifndef RAYMILL_PACKET_H
#define RAYMILL_PACKET_H

#include "lib/chunk.h"

#define PAIRS (GROUPS / 2)
#define ALL_GROUPS ((1u << GROUPS) - 1u)
#define ENTRY_GROUPS_SHIFT 3u  // in a stack entry, above the lane

// Directions that differ by more than this on an axis share too few nodes to be worth it.
#define COHERENT_SPREAD 0.5f
#define FEWEST_TOGETHER 12  // rays

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
    bool is_pinhole;  // all rays start at one point
} Packet;

static inline float min_lane(float16 v) {
    const float8 v8 = min8(v.lo, v.hi);
    const float4 v4 = select(v8.hi, v8.lo, v8.lo < v8.hi);
    const float2 v2 = select(v4.hi, v4.lo, v4.lo < v4.hi);
    return v2.x < v2.y ? v2.x : v2.y;
}

static inline float max_lane(float16 v) {
    const float8 v8 = max8(v.lo, v.hi);
    const float4 v4 = select(v8.hi, v8.lo, v8.lo > v8.hi);
    const float2 v2 = select(v4.hi, v4.lo, v4.lo > v4.hi);
    return v2.x > v2.y ? v2.x : v2.y;
}

static inline float16 twice(float8 v) { return (float16)(v, v); }

static inline uint lane_mask16(int16 comparison) {
    return lane_mask(comparison.lo) | lane_mask(comparison.hi) << 8;
}

static inline bool any16(int16 comparison) {
    const ulong2 bytes = as_ulong2(convert_char16(comparison));
    return (bytes.x | bytes.y) != 0;
}

/// The rays of one octant, one bit each.
static inline ulong rays_of_octant(const RayChunk* c, uint octant) {
    ulong members = 0;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group)
        members |= (ulong)lane_mask16(c->octant[group] == octant) << (GROUP * group);
    return members;
}

/// Whether the rays, all of one octant, share so much of the hierarchy that they are better traced together.
static inline bool are_close(const RayChunk* c) {
    for (uint axis = 0; axis < 3; ++axis) {
        float16 lower = c->direction[axis][0], upper = lower;
        for (uint group = 1; group < GROUPS; ++group) {
            lower = min16(lower, c->direction[axis][group]);
            upper = max16(upper, c->direction[axis][group]);
        }
        if (max_lane(upper) - min_lane(lower) > COHERENT_SPREAD) return false;
    }
    return true;
}

static inline void set_group(float16* pairs, uint group, float value) {
    ((float8*)pairs)[group] = (float8)(value);
}

static inline void update_farthest(Packet* p) {
    float farthest = -1.0f;
#pragma unroll
    for (uint group = 0; group < GROUPS; ++group) {
        const float here = max_lane(p->rays.best_t[group]);
        set_group(p->farthest, group, here);
        farthest = here > farthest ? here : farthest;
    }
    p->farthest_of_all = farthest;
}

/// Where along z the first and the last ray reach a plane. A single ray's distances are up to 5 roundings of
/// origin * inverse away from the middle (slabs.h), ours 3 more.
static inline void prepare_depth(Packet* p, uint group) {
    const uint z = p->axis[2], sign = p->sign[z];
    const float lower = min_lane(p->rays.origin[z][group]), upper = max_lane(p->rays.origin[z][group]);
    const float smallest = min_lane(p->rays.inverse[z][group]), largest = max_lane(p->rays.inverse[z][group]);
    const float slack = 16.0f * ROUNDING * fmax(fabs(lower), fabs(upper));
    const float slow = sign ? largest : smallest, fast = sign ? smallest : largest;  // smaller and larger |inverse|
    set_group(p->enter_scale, group, slow);
    set_group(p->enter_offset, group, -(sign ? lower : upper) * slow - slack * fabs(slow));
    set_group(p->leave_scale, group, fast);
    set_group(p->leave_offset, group, -(sign ? upper : lower) * fast + slack * fabs(fast));
}

/// Widened by more than what the tests of single rays may be off: a few roundings of the origins, the waist and what lies
/// between for the bound, of the depth for the slope (slopes are at most 1).
static inline void prepare_beam(Packet* p, uint group) {
    const float16 to_waist = p->waist - p->rays.origin[p->axis[2]][group];
    for (uint a = 0; a < 2; ++a) {
        const float16 origin = p->rays.origin[p->axis[a]][group], slope = p->rays.shear[a][group];
        const float16 place = fma(slope, to_waist, origin);
        const float slack = 32.0f * ROUNDING * (max_lane(fabs(origin) + fabs(to_waist)) + fabs(p->waist));
        const float rising = max_lane(slope * p->side) + 32.0f * ROUNDING;
        const float falling = min_lane(slope * p->side) - 32.0f * ROUNDING;
        set_group(p->slope[0][a], group, -falling);
        set_group(p->slope[1][a], group, rising);
        set_group(p->bound[0][a], group, slack - min_lane(place));
        set_group(p->bound[1][a], group, slack + max_lane(place));
    }
}

/// How wide the packet is where its rays reach a plane square to z.
static inline float width_at(const Packet* p, float z) {
    float width = 0.0f;
    for (uint a = 0; a < 2; ++a) {
        float16 lower = (float16)(INFINITY), upper = (float16)(-INFINITY);
        for (uint group = 0; group < GROUPS; ++group) {
            const float16 place = fma(p->rays.shear[a][group], z - p->rays.origin[p->axis[2]][group],
                                      p->rays.origin[p->axis[a]][group]);
            lower = min16(lower, place);
            upper = max16(upper, place);
        }
        width += max_lane(upper) - min_lane(lower);
    }
    return width;
}

/// Where along z the first and the last ray come closest; not finite if they are parallel.
static inline float crossing(const Packet* p) {
    const RayChunk* c = &p->rays;
    const uint z = p->axis[2], last = c->count - 1;
    const float slope_x = get_lane(c->shear[0], last) - get_lane(c->shear[0], 0);
    const float slope_y = get_lane(c->shear[1], last) - get_lane(c->shear[1], 0);
    const uint a = fabs(slope_x) > fabs(slope_y) ? 0 : 1;
    const float apart_z = get_lane(c->origin[z], last) - get_lane(c->origin[z], 0);
    const float apart = get_lane(c->origin[p->axis[a]], last) - get_lane(c->origin[p->axis[a]], 0);
    return get_lane(c->origin[z], 0) + (get_lane(c->shear[a], last) * apart_z - apart) / (a == 0 ? slope_x : slope_y);
}

/// Finds the waist: where the packet is narrowest of where its rays start, end, or seem to come from or go to beyond
/// these. In between it will not do: a beam that converged and widened again would not be one.
static inline void find_waist(Packet* p) {
    const RayChunk* c = &p->rays;
    const uint z = p->axis[2];
    const float travel = p->sign[z] ? -1.0f : 1.0f;
    float16 start16 = (float16)(INFINITY), end16 = (float16)(-INFINITY);
    for (uint group = 0; group < GROUPS; ++group) {
        const float16 start = c->origin[z][group] * travel;
        start16 = min16(start, start16);
        end16 = max16(fma(fabs(c->direction[z][group]), max16(c->best_t[group], (float16)(0.0f)), start), end16);
    }
    const float start = min_lane(start16), end = max_lane(end16);
    p->waist = start * travel;
    p->side = travel;
    float width = width_at(p, p->waist);
    if (width == 0.0f) return;
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

/// Makes a packet of its coherent rays.
static inline void packet_prepare(Packet* p) {
    const uint octant = p->rays.octant[0].s0;
    for (uint axis = 0; axis < 3; ++axis) p->sign[axis] = octant >> (OCTANT_SIGN + axis) & 1u;
    const TriangleFrame frame = frame_axes(octant & OCTANT_AXIS, p->sign[octant & OCTANT_AXIS] != 0);
    p->axis[0] = frame.x;
    p->axis[1] = frame.y;
    p->axis[2] = frame.z;
    find_waist(p);
    p->is_pinhole = width_at(p, p->waist) == 0.0f && p->waist == p->rays.origin[frame.z][0].s0;
    for (uint group = 0; group < GROUPS; ++group) {
        prepare_depth(p, group);
        prepare_beam(p, group);
    }
    update_farthest(p);
}

/// Which of eight boxes some ray of each group may meet, bit 8 * group + box, and where the first ray can enter them.
/// A box lies outside a beam if all its corners lie on the far side of one of the beam's planes.
static inline uint groups_meeting_children(const Packet* p, global const BvhNode* node, float8* entry) {
    const uint z = p->axis[2];
    const float16 enter_z = twice(aligned8(node->bounds[p->sign[z]][z]));
    const float16 leave_z = twice(aligned8(node->bounds[1 - p->sign[z]][z]));
    const float16 depth0 = (enter_z - p->waist) * p->side, depth1 = (leave_z - p->waist) * p->side;
    const float16 lower_x = twice(aligned8(node->bounds[0][p->axis[0]])), upper_x = twice(aligned8(node->bounds[1][p->axis[0]]));
    const float16 lower_y = twice(aligned8(node->bounds[0][p->axis[1]])), upper_y = twice(aligned8(node->bounds[1][p->axis[1]]));
    uint mask = 0;
    *entry = (float8)(INFINITY);
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
        *entry = min8(min8(enter.lo, enter.hi), *entry);
    }
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

/// Whether a ray of the group meets child `lane`.
static inline bool group_meets(const Packet* p, global const BvhNode* node, uint lane, uint group) {
    float16 enter = (float16)(0.0f), leave = p->rays.best_t[group];
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 inverse = p->rays.inverse[axis][group];
        const float near = node->bounds[p->sign[axis]][axis][lane], far = node->bounds[1 - p->sign[axis]][axis][lane];
        enter = max16(fma((float16)(near), inverse, p->rays.near[axis][group]), enter);
        leave = min16(fma((float16)(far), inverse, p->rays.far[axis][group]), leave);
    }
    return any16(enter <= leave * (1.0f + 8.0f * ROUNDING));
}

/// One bit a group in the lowest four, spread to all boxes of groups_meeting()'s mask; and the groups of one box.
static inline uint spread_groups(uint groups) { return (groups * 0x00204081u & 0x01010101u) * 0xffu; }
static inline uint groups_of_box(uint mask, uint box) { return (mask >> box & 0x01010101u) * 0x01020408u >> 24 & ALL_GROUPS; }

/// Where the rays of a group enter the bounds of one triangle: enter_triangles() in triangle.h.
static inline float16 enter_triangle_group(const Packet* p, global const TriangleBlock* block, uint lane, uint group) {
    float16 enter = (float16)(0.0f);
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 inverse = p->rays.inverse[axis][group], near = p->rays.near[axis][group];
        const float16 a = fma((float16)(block->position[0][axis][lane]), inverse, near);
        const float16 b = fma((float16)(block->position[1][axis][lane]), inverse, near);
        const float16 c = fma((float16)(block->position[2][axis][lane]), inverse, near);
        enter = max16(min16(min16(a, b), c), enter);
    }
    return enter;
}

/// Takes a primitive as the best hit of some rays of a group. With any_hit they are done.
static inline void take_hits(RayChunk* c, uint group, int16 hit, uint primitive, float16 t, float16 u, float16 v,
                             bool any_hit) {
    c->best_primitive[group] = select(c->best_primitive[group], (uint16)(primitive), hit);
    c->best_t[group] = select(c->best_t[group], any_hit ? (float16)(-1.0f) : t, hit);
    c->best_u[group] = select(c->best_u[group], u, hit);
    c->best_v[group] = select(c->best_v[group], v, hit);
}

/// Rays of a group that hit one triangle nearer than their best so far; replaces it. The arithmetic is that of
/// intersect_triangles() in triangle.h, with rays in the place of triangles.
static inline bool visit_triangle_group(Packet* p, global const TriangleBlock* block, uint lane, uint group,
                                        bool any_hit) {
    RayChunk* c = &p->rays;
    const uint x = p->axis[0], y = p->axis[1], z = p->axis[2];
    const float16 origin_x = c->origin[x][group], origin_y = c->origin[y][group], origin_z = c->origin[z][group];
    const float16 shear_x = -c->shear[0][group], shear_y = -c->shear[1][group];
    const float16 az = block->position[0][z][lane] - origin_z;
    const float16 bz = block->position[1][z][lane] - origin_z;
    const float16 cz = block->position[2][z][lane] - origin_z;
    const float16 ax = fma(shear_x, az, block->position[0][x][lane] - origin_x);
    const float16 ay = fma(shear_y, az, block->position[0][y][lane] - origin_y);
    const float16 bx = fma(shear_x, bz, block->position[1][x][lane] - origin_x);
    const float16 by = fma(shear_y, bz, block->position[1][y][lane] - origin_y);
    const float16 cx = fma(shear_x, cz, block->position[2][x][lane] - origin_x);
    const float16 cy = fma(shear_y, cz, block->position[2][y][lane] - origin_y);
    const float16 ua = cx * by - cy * bx;
    const float16 va = ax * cy - ay * cx;
    const float16 wa = bx * ay - by * ax;
    const float16 smallest = min16(min16(ua, va), wa), largest = max16(max16(ua, va), wa);
    int16 hit = (smallest >= 0.0f) | (largest <= 0.0f);
    if (!any16(hit)) return false;

    const float16 det = ua + va + wa;
    const float16 inverse = 1.0f / det;
    const float16 shear_z = c->shear[2][group];
    const float16 distance = fma(ua, az, fma(va, bz, wa * cz)) * shear_z * inverse;
    const float16 best_t = c->best_t[group];
    hit &= (distance <= best_t) & (det != 0.0f);
    if (!any16(hit)) return false;

    const float16 x16 = max16(max16(fabs(ax), fabs(bx)), fabs(cx));
    const float16 y16 = max16(max16(fabs(ay), fabs(by)), fabs(cy));
    const float16 z16 = max16(max16(fabs(az), fabs(bz)), fabs(cz));
    const float16 e = max16(max16(fabs(ua), fabs(va)), fabs(wa));
    const float16 delta_e = 2.0f * ROUNDING * (2.0f * x16 * y16 + 5.0f * ((y16 + z16) * x16 + (x16 + z16) * y16));
    const float16 delta = 3.0f * (6.0f * ROUNDING * e + delta_e) * z16 * fabs(shear_z) * fabs(inverse);
    hit &= distance > delta;
    const float16 t = max16(enter_triangle_group(p, block, lane, group), distance);
    const uint primitive = block->primitive[lane];
    hit &= (t < best_t) | ((t == best_t) & (primitive < c->best_primitive[group]));

    uint on_edge = lane_mask16(hit & ((ua == 0.0f) | (va == 0.0f) | (wa == 0.0f)));
    for (; on_edge != 0; on_edge &= on_edge - 1) {
        const uint ray = lowest_bit(on_edge);
        if (!inside_exactly(get_lane(&ax, ray), get_lane(&ay, ray), get_lane(&bx, ray), get_lane(&by, ray),
                            get_lane(&cx, ray), get_lane(&cy, ray)))
            ((int*)&hit)[ray] = 0;
    }
    if (!any16(hit)) return false;
    take_hits(c, group, hit, primitive, t, va * inverse, wa * inverse, any_hit);
    return true;
}

/// Rays of a group that hit one sphere nearer than their best so far; replaces it. The arithmetic is that of
/// intersect_spheres() in sphere.h, with rays in the place of spheres.
static inline bool visit_sphere_group(Packet* p, global const SphereBlock* block, uint lane, uint group, bool any_hit) {
    RayChunk* c = &p->rays;
    const float16 dx = c->direction[0][group], dy = c->direction[1][group], dz = c->direction[2][group];
    const float16 fx = c->origin[0][group] - block->center[0][lane];
    const float16 fy = c->origin[1][group] - block->center[1][lane];
    const float16 fz = c->origin[2][group] - block->center[2][lane];
    const float r = block->radius[lane];
    const float16 a = fma(dx, dx, fma(dy, dy, dz * dz));
    const float16 b = -fma(fx, dx, fma(fy, dy, fz * dz));
    const float16 along = b / a;
    const float16 px = fma(along, dx, fx), py = fma(along, dy, fy), pz = fma(along, dz, fz);
    const float r2 = r * r;
    const float16 discriminant = r2 - fma(px, px, fma(py, py, pz * pz));
    int16 hit = discriminant >= 0.0f;
    if (!any16(hit)) return false;

    float16 enter = (float16)(0.0f), leave = (float16)(INFINITY);
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float lower = block->center[axis][lane] - r, upper = block->center[axis][lane] + r;
        const float16 inverse = c->inverse[axis][group];
        const float first = p->sign[axis] ? upper : lower, last = p->sign[axis] ? lower : upper;
        enter = max16(fma((float16)(first), inverse, c->near[axis][group]), enter);
        leave = min16(fma((float16)(last), inverse, c->far[axis][group]), leave);
    }
    const float16 root = sqrt(a * max16(discriminant, (float16)(0.0f)));
    const float16 q = b + copysign(root, b);
    const float16 t0 = (fma(fx, fx, fma(fy, fy, fz * fz)) - r2) / q, t1 = q / a;
    const float16 near = min16(t0, t1), far = max16(t0, t1);
    const float16 entry = select(near, max16(enter, near), near > 0.0f), exit = max16(enter, far);
    const int16 entry_counts = entry > 0.0f, exit_counts = (far > 0.0f) & (exit > 0.0f);
    const float16 t = select(exit, entry, entry_counts), best_t = c->best_t[group];
    const uint primitive = block->primitive[lane];
    hit &= (enter <= leave * (1.0f + 8.0f * ROUNDING)) & (entry_counts | exit_counts);
    hit &= (t < best_t) | ((t == best_t) & (primitive < c->best_primitive[group]));
    if (!any16(hit)) return false;
    take_hits(c, group, hit, primitive, t, (float16)(0.0f), (float16)(0.0f), any_hit);
    return true;
}

/// Pushes the children that some group meets, the nearest on top. An entry is that of push_children() in traverse.h with
/// the groups in the next four bits of the distance, which only makes it a little smaller.
static inline uint push_groups(const Geometry* geometry, global const uint* children, uint mask, float8 entry, ulong* stack, uint top) {
    uint met = (mask | mask >> 16) & 0xffffu;
    met = (met | met >> 8) & 0xffu;
    if (met == 0) return top;
    uint key[BVH_WIDTH], place[BVH_WIDTH];
    const uint8 key8 = as_uint8(entry) & ~(7u | ALL_GROUPS << ENTRY_GROUPS_SHIFT);
    *(uint8*)key = key8;
    *(uint8*)place = places_by_distance(key8, met);
    const uint count = popcount(met);
    for (; met != 0; met &= met - 1) {
        const uint lane = lowest_bit(met);
        const uint groups = groups_of_box(mask, lane);
        stack[top + place[lane]] = (ulong)(key[lane] | groups << ENTRY_GROUPS_SHIFT) << 32 | children[lane];
        prefetch_child(geometry, children[lane]);
    }
    return top + count;
}

/// Tests each group's rays against those triangles of a block whose bounds some of them may meet.
static inline bool visit_triangles_groups(Packet* p, global const TriangleBlock* block, uint groups, bool any_hit) {
    bool found = false;
    for (uint meeting = groups_meeting_triangles(p, block) & spread_groups(groups); meeting != 0; meeting &= meeting - 1) {
        const uint bit = lowest_bit(meeting);
        found |= visit_triangle_group(p, block, bit % BVH_WIDTH, bit / BVH_WIDTH, any_hit);
    }
    return found;
}

static inline bool visit_spheres_groups(Packet* p, global const SphereBlock* block, uint groups, bool any_hit) {
    bool found = false;
    for (uint lane = 0; lane < BVH_WIDTH && block->primitive[lane] != NO_INDEX; ++lane)
        for (uint group = 0; group < GROUPS; ++group)
            if (groups >> group & 1u) found |= visit_sphere_group(p, block, lane, group, any_hit);
    return found;
}

/// Finds the closest hit of every ray of a coherent packet among the primitives of the hierarchy, or with any_hit whether
/// there is one.
static void traverse_packet(const Geometry* geometry, Packet* p, bool any_hit) {
    if (geometry->node_count == 0) return;
    ulong stack[STACK_SIZE];
    stack[0] = (ulong)(ALL_GROUPS << ENTRY_GROUPS_SHIFT) << 32;
    uint top = 1;
    while (top > 0) {
        const ulong item = stack[--top];
        const uint distance = (uint)(item >> 32), child = (uint)item;
        if (as_float(distance & ~(7u | ALL_GROUPS << ENTRY_GROUPS_SHIFT)) > p->farthest_of_all) continue;
        const uint groups = distance >> ENTRY_GROUPS_SHIFT & ALL_GROUPS;
        if (!(child & CHILD_LEAF)) {
            global const BvhNode* node = geometry->nodes + child;
            float8 entry;
            uint mask = groups_meeting_children(p, node, &entry) & spread_groups(groups);
            if (!p->is_pinhole) {
                for (uint rest = mask; rest != 0; rest &= rest - 1) {
                    const uint bit = lowest_bit(rest);
                    if (!group_meets(p, node, bit % BVH_WIDTH, bit / BVH_WIDTH)) mask &= ~(1u << bit);
                }
            }
            top = push_groups(geometry, node->child, mask, entry, stack, top);
            continue;
        }
        const uint first = child & CHILD_FIRST_MASK;
        const uint last = first + (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK);
        bool found = false;
        for (uint block = first; block <= last; ++block)
            found |= child & CHILD_SPHERES ? visit_spheres_groups(p, geometry->spheres + block, groups, any_hit)
                                           : visit_triangles_groups(p, geometry->triangles + block, groups, any_hit);
        if (found) update_farthest(p);
    }
}

/// Traces rays of one octant: together if they are close, else one by one.
static void traverse_octant(const Geometry* geometry, Packet* p, bool any_hit) {
    RayChunk* c = &p->rays;
    if (c->count >= FEWEST_TOGETHER && are_close(c)) {
        packet_prepare(p);
        traverse_packet(geometry, p, any_hit);
        return;
    }
    for (uint i = 0; i < c->count; ++i)
        if (get_lane(c->best_t, i) >= 0.0f) chunk_set_hit(c, i, chunk_traverse_ray(c, geometry, i, any_hit));
}

/// Finds the closest hit of every ray of a chunk, or with any_hit whether there is one.
static inline void traverse_chunk(const Geometry* geometry, Packet* p, bool any_hit) {
    RayChunk* c = &p->rays;
    chunk_visit_planes(c, geometry);
    if (any_hit)
        for (uint group = 0; group < GROUPS; ++group)
            c->best_t[group] = select(c->best_t[group], (float16)(-1.0f), c->best_primitive[group] != NO_INDEX);
    ulong waiting = c->count < CHUNK ? (1ul << c->count) - 1ul : ~0ul;
    if ((waiting & ~rays_of_octant(c, c->octant[0].s0)) == 0) {
        traverse_octant(geometry, p, any_hit);
        return;
    }
    Packet part;
    while (waiting != 0) {
        const ulong members = waiting & rays_of_octant(c, get_octant(c, lowest_bit64(waiting)));
        waiting &= ~members;
        if (popcount(members) < FEWEST_TOGETHER) {
            for (ulong rest = members; rest != 0; rest &= rest - 1) {
                const uint i = lowest_bit64(rest);
                if (get_lane(c->best_t, i) >= 0.0f) chunk_set_hit(c, i, chunk_traverse_ray(c, geometry, i, any_hit));
            }
            continue;
        }
        uint count = 0;
        for (ulong rest = members; rest != 0; rest &= rest - 1) chunk_copy(&part.rays, count++, c, lowest_bit64(rest));
        chunk_prepare(&part.rays, count);
        traverse_octant(geometry, &part, any_hit);
        count = 0;
        for (ulong rest = members; rest != 0; rest &= rest - 1)
            chunk_set_hit(c, lowest_bit64(rest), chunk_hit(&part.rays, count++));
    }
}

#endif
