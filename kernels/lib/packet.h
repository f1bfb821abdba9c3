// A chunk of coherent rays through the hierarchy together: one visit of a node or triangle serves all of them.
// What each ray finds is the same to the last bit as alone: the arithmetic of each test is that of traverse.h, triangle.h
// and sphere.h, sixteen rays against one primitive instead of one ray against eight, and which hit wins does not depend on
// the order.
// Sources: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 2007
// (interval tests); Overbeck, Ramamoorthi, Mark, "Large Ray Packets for Real-time Whitted Ray Tracing", 2008.
#ifndef RAYMILL_PACKET_H
#define RAYMILL_PACKET_H

#include "lib/chunk.h"

#define ALL_GROUPS ((1u << GROUPS) - 1u)

// Directions that differ by more than this on an axis share too few nodes to be worth it.
#define COHERENT_SPREAD 0.5f

/// What holds for all of some rays of the same octant: bounds of their frames, [0] lower and [1] upper.
typedef struct {
    float origin[2][3], inverse[2][3];
    float margin[3];  // what rounding may take from or add to a distance to a plane, at most
} Interval;

/// Coherent rays: their largest axes and the signs of their directions are the same, which the arithmetic relies on.
typedef struct {
    RayChunk rays;
    Interval all, group[GROUPS];
    uint axis[3];    // of the triangle frame: x, y, z
    uint sign[3];    // of the slab frame
    float farthest;  // largest best_t
} Packet;

static inline float min_lane(float16 v) {
    const float8 v8 = min8(v.lo, v.hi);
    const float4 v4 = fmin(v8.lo, v8.hi);
    return fmin(fmin(v4.x, v4.y), fmin(v4.z, v4.w));
}

static inline float max_lane(float16 v) {
    const float8 v8 = max8(v.lo, v.hi);
    const float4 v4 = fmax(v8.lo, v8.hi);
    return fmax(fmax(v4.x, v4.y), fmax(v4.z, v4.w));
}

static inline uint lane_mask16(int16 comparison) {
    return lane_mask(comparison.lo) | lane_mask(comparison.hi) << 8;
}

static inline bool any16(int16 comparison) {
    const ulong2 bytes = as_ulong2(convert_char16(comparison));
    return (bytes.x | bytes.y) != 0;
}

/// Whether the rays share so much of the hierarchy that they are better traced together.
static inline bool are_coherent(const RayChunk* c) {
    if (c->count <= GROUP) return false;
    const uint octant = c->octant[0].s0;
    uint16 differing = (uint16)(0);
    for (uint group = 0; group < GROUPS; ++group) differing |= c->octant[group] ^ octant;
    if (any16(differing != 0)) return false;
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

static inline Interval group_interval(const RayChunk* c, uint group) {
    Interval r;
    for (uint axis = 0; axis < 3; ++axis) {
        r.origin[0][axis] = min_lane(c->origin[axis][group]);
        r.origin[1][axis] = max_lane(c->origin[axis][group]);
        r.inverse[0][axis] = min_lane(c->inverse[axis][group]);
        r.inverse[1][axis] = max_lane(c->inverse[axis][group]);
        // near and far are an error of three roundings apart from the middle, each rounded once more; planes add two.
        r.margin[axis] = 2.0f * max_lane(c->far[axis][group] - c->near[axis][group]);
    }
    return r;
}

static inline void extend_interval(Interval* r, const Interval* by) {
    for (uint axis = 0; axis < 3; ++axis) {
        r->origin[0][axis] = fmin(r->origin[0][axis], by->origin[0][axis]);
        r->origin[1][axis] = fmax(r->origin[1][axis], by->origin[1][axis]);
        r->inverse[0][axis] = fmin(r->inverse[0][axis], by->inverse[0][axis]);
        r->inverse[1][axis] = fmax(r->inverse[1][axis], by->inverse[1][axis]);
        r->margin[axis] = fmax(r->margin[axis], by->margin[axis]);
    }
}

static inline float farthest_best(const RayChunk* c) {
    float16 t = c->best_t[0];
    for (uint group = 1; group < GROUPS; ++group) t = max16(t, c->best_t[group]);
    return max_lane(t);
}

/// Makes a packet of its coherent rays.
static inline void packet_prepare(Packet* p) {
    const uint octant = p->rays.octant[0].s0;
    for (uint axis = 0; axis < 3; ++axis) p->sign[axis] = octant >> (OCTANT_SIGN + axis) & 1u;
    const TriangleFrame frame = frame_axes(octant & OCTANT_AXIS, p->sign[octant & OCTANT_AXIS] != 0);
    p->axis[0] = frame.x;
    p->axis[1] = frame.y;
    p->axis[2] = frame.z;
    for (uint group = 0; group < GROUPS; ++group) p->group[group] = group_interval(&p->rays, group);
    p->all = p->group[0];
    for (uint group = 1; group < GROUPS; ++group) extend_interval(&p->all, &p->group[group]);
    p->farthest = farthest_best(&p->rays);
}

/// Distances at which the first of the rays can enter (near = 1) or the last can leave (near = 0) eight slabs.
static inline float8 interval(const Interval* r, float8 plane, uint axis, uint upper, uint near) {
    const float8 distance = plane - r->origin[1 - upper][axis];
    const float8 a = distance * r->inverse[0][axis], b = distance * r->inverse[1][axis];
    return near ? min8(a, b) - r->margin[axis] : max8(a, b) + r->margin[axis];
}

/// Boxes that some of the rays may meet up to `farthest`, and where the first ray can enter them. planes: eight lower
/// planes per axis, then eight upper ones.
static inline uint interval_meets(const Packet* p, const Interval* r, const float8 lower[3], const float8 upper[3],
                                  float8* entry) {
    float8 enter = (float8)(0.0f), leave = (float8)(p->farthest);
    for (uint axis = 0; axis < 3; ++axis) {
        const uint sign = p->sign[axis];  // which plane comes first depends on it
        enter = max8(interval(r, sign ? upper[axis] : lower[axis], axis, sign, 1), enter);
        leave = min8(interval(r, sign ? lower[axis] : upper[axis], axis, 1 - sign, 0), leave);
    }
    // No later than group_meets() and enter_triangle_group() say for any ray: those have the margin, and these 4 roundings.
    *entry = enter * (1.0f - 4.0f * ROUNDING);
    return lane_mask(*entry <= leave * (1.0f + 8.0f * ROUNDING));
}

/// Children that some ray of the packet may meet.
static inline uint interval_children(const Packet* p, global const BvhNode* node, float8* entry) {
    float8 lower[3], upper[3];
    for (uint axis = 0; axis < 3; ++axis) {
        lower[axis] = aligned8(node->bounds[0][axis]);
        upper[axis] = aligned8(node->bounds[1][axis]);
    }
    return interval_meets(p, &p->all, lower, upper, entry);
}

/// Bounds of a block's triangles.
static inline void triangle_bounds(global const TriangleBlock* block, float8 lower[3], float8 upper[3]) {
    for (uint axis = 0; axis < 3; ++axis) {
        const float8 a = aligned8(block->position[0][axis]), b = aligned8(block->position[1][axis]);
        const float8 c = aligned8(block->position[2][axis]);
        lower[axis] = min8(min8(a, b), c);
        upper[axis] = max8(max8(a, b), c);
    }
}

/// Whether a ray of the group meets child `lane`.
static inline bool group_meets(const Packet* p, global const BvhNode* node, uint lane, uint group) {
    float16 enter = (float16)(0.0f), leave = p->rays.best_t[group];
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 inverse = p->rays.inverse[axis][group];
        const float near = node->bounds[p->sign[axis]][axis][lane], far = node->bounds[1 - p->sign[axis]][axis][lane];
        enter = max16(fma((float16)(near), inverse, p->rays.near[axis][group]), enter);
        leave = min16(fma((float16)(far), inverse, p->rays.far[axis][group]), leave);
    }
    return any16(enter <= leave * (1.0f + 8.0f * ROUNDING));
}

/// Where the rays of a group enter the bounds of one triangle: enter_triangles() in triangle.h.
static inline float16 enter_triangle_group(const Packet* p, global const TriangleBlock* block, uint lane, uint group) {
    float16 enter = (float16)(0.0f);
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
    int16 hit = ((smallest >= 0.0f) & (largest > 0.0f)) | ((largest <= 0.0f) & (smallest < 0.0f));
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
static inline uint push_groups(const Packet* p, global const BvhNode* node, uint mask, float8 entry, uint groups,
                               ulong* stack, uint top) {
    uint meeting[BVH_WIDTH] = {0, 0, 0, 0, 0, 0, 0, 0};
    uint met = 0;
    for (; mask != 0; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        uint here = 0;
        for (uint group = 0; group < GROUPS; ++group)
            if ((groups >> group & 1u) && group_meets(p, node, lane, group)) here |= 1u << group;
        meeting[lane] = here;
        if (here != 0) met |= 1u << lane;
    }
    if (met == 0) return top;
    const uint8 is_met = ((uint8)(met) & (uint8)(1, 2, 4, 8, 16, 32, 64, 128)) != 0 ? (uint8)(~0u) : (uint8)(0);
    const uint8 distance = as_uint8(entry) & ~(7u | ALL_GROUPS << 3);
    uint key[BVH_WIDTH], place[BVH_WIDTH];
    *(uint8*)key = distance | *(const uint8*)meeting << 3;
    *(uint8*)place = places_by_distance(distance | (uint8)(0, 1, 2, 3, 4, 5, 6, 7) | ~is_met);
    const uint count = popcount(met);
    for (; met != 0; met &= met - 1) {
        const uint lane = lowest_bit(met);
        stack[top + place[lane]] = (ulong)key[lane] << 32 | node->child[lane];
    }
    return top + count;
}

/// Tests the groups' rays against a block of triangles: those whose bounds some ray of the group may meet.
static inline bool visit_triangles_groups(Packet* p, global const TriangleBlock* block, uint groups, bool any_hit) {
    float8 lower[3], upper[3], entry;
    triangle_bounds(block, lower, upper);
    bool found = false;
    for (uint group = 0; group < GROUPS; ++group) {
        if (!(groups >> group & 1u)) continue;
        for (uint mask = interval_meets(p, &p->group[group], lower, upper, &entry); mask != 0; mask &= mask - 1)
            found |= visit_triangle_group(p, block, lowest_bit(mask), group, any_hit);
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
    stack[0] = (ulong)(ALL_GROUPS << 3) << 32;
    uint top = 1;
    while (top > 0) {
        const ulong item = stack[--top];
        const uint groups = (uint)(item >> 35) & ALL_GROUPS;
        if (as_float((uint)(item >> 32) & ~(7u | ALL_GROUPS << 3)) > p->farthest) continue;
        const uint child = (uint)item;
        if (!(child & CHILD_LEAF)) {
            float8 entry;
            const uint mask = interval_children(p, geometry->nodes + child, &entry);
            top = push_groups(p, geometry->nodes + child, mask, entry, groups, stack, top);
            continue;
        }
        bool found = false;
        const uint first = child & CHILD_FIRST_MASK;
        const uint last = first + (child >> CHILD_BLOCKS_SHIFT & CHILD_BLOCKS_MASK);
        for (uint block = first; block <= last; ++block)
            found |= child & CHILD_SPHERES ? visit_spheres_groups(p, geometry->spheres + block, groups, any_hit)
                                           : visit_triangles_groups(p, geometry->triangles + block, groups, any_hit);
        if (found) p->farthest = farthest_best(&p->rays);
    }
}

/// Finds the closest hit of every ray of a chunk, or with any_hit whether there is one: together if they are coherent,
/// else one by one.
static inline void traverse_chunk(const Geometry* geometry, Packet* p, bool any_hit) {
    RayChunk* c = &p->rays;
    chunk_visit_planes(c, geometry);
    if (any_hit)
        for (uint group = 0; group < GROUPS; ++group)
            c->best_t[group] = select(c->best_t[group], (float16)(-1.0f), c->best_primitive[group] != NO_INDEX);
    if (are_coherent(c)) {
        packet_prepare(p);
        traverse_packet(geometry, p, any_hit);
        return;
    }
    for (uint i = 0; i < c->count; ++i)
        if (get_lane(c->best_t, i) >= 0.0f) chunk_set_hit(c, i, chunk_traverse_ray(c, geometry, i, any_hit));
}

#endif
