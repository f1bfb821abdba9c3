// A chunk of coherent rays through the hierarchy together: one visit of a node or triangle serves all of them.
// What each ray finds is the same to the last bit as alone: the arithmetic of each test is that of traverse.h and triangle.h,
// sixteen rays against one triangle instead of one ray against eight, and which hit wins does not depend on the order.
// Sources: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 2007
// (interval tests); Overbeck, Ramamoorthi, Mark, "Large Ray Packets for Real-time Whitted Ray Tracing", 2008.
#ifndef RAYMILL_PACKET_H
#define RAYMILL_PACKET_H

#include "lib/traverse.h"

#define GROUP 16                 // rays of one vector
#define GROUPS (CHUNK / GROUP)   // vectors of a packet
#define ALL_GROUPS ((1u << GROUPS) - 1u)

// Directions that differ by more than this on an axis share too few nodes to be worth it.
#define COHERENT_SPREAD 0.5f

/// Up to CHUNK rays as structure of arrays. Rays that are done or missing have best_t = -1, which no distance is below.
typedef struct {
    float origin[3][CHUNK];  // in the order of the axes x, y, z of the triangle frame
    float shear[3][CHUNK];
    float inverse[3][CHUNK], near[3][CHUNK], far[3][CHUNK];  // in the order of the world's axes
    float best_t[CHUNK], best_u[CHUNK], best_v[CHUNK];
    uint best_primitive[CHUNK];
    uint axis[3];  // of the triangle frame, the same for all rays
    uint sign[3];  // of the slab frame, the same for all rays
    float3 lower_origin, upper_origin, lower_inverse, upper_inverse;
    float3 margin;  // what rounding may take from or add to a distance to a plane, at most
    float farthest;  // largest best_t
    uint count;
} Packet;

/// Whether rays with these directions share so much of the hierarchy that they are better traced together. Coherent rays
/// have the same largest axis and the same signs, which the packet's arithmetic relies on.
static inline bool are_coherent(const float3* directions, uint count) {
    if (count <= GROUP) return false;
    float3 lower = directions[0], upper = directions[0];
    int3 different_signs = (int3)(0);
    bool same_axis = true;
    const uint axis = largest_axis(directions[0]);
    for (uint i = 1; i < count; ++i) {
        lower = fmin(lower, directions[i]);
        upper = fmax(upper, directions[i]);
        different_signs |= as_int3(directions[i]) ^ as_int3(directions[0]);
        same_axis &= largest_axis(directions[i]) == axis;
    }
    return same_axis && !any(different_signs) && max3(upper - lower) <= COHERENT_SPREAD;
}

/// Call packet_add() for each of at most CHUNK coherent rays, then packet_fill().
static inline void packet_start(Packet* p) {
    p->lower_origin = p->lower_inverse = (float3)(INFINITY);
    p->upper_origin = p->upper_inverse = (float3)(-INFINITY);
    p->margin = (float3)(0.0f);
    p->farthest = -1.0f;
    p->count = 0;
}

/// Adds a ray whose best hit so far is `best`.
static inline void packet_add(Packet* p, float3 origin, float3 direction, Hit best) {
    const SlabFrame slabs = slab_frame(origin, direction);
    const TriangleFrame frame = triangle_frame(origin, direction);
    const uint i = p->count++;
    if (i == 0) {
        p->axis[0] = frame.x;
        p->axis[1] = frame.y;
        p->axis[2] = frame.z;
        for (uint axis = 0; axis < 3; ++axis) p->sign[axis] = slabs.sign[axis];
    }
    p->origin[0][i] = frame.origin_x;
    p->origin[1][i] = frame.origin_y;
    p->origin[2][i] = frame.origin_z;
    p->shear[0][i] = frame.shear_x;
    p->shear[1][i] = frame.shear_y;
    p->shear[2][i] = frame.shear_z;
    for (uint axis = 0; axis < 3; ++axis) {
        p->inverse[axis][i] = component(slabs.inverse, axis);
        p->near[axis][i] = component(slabs.near, axis);
        p->far[axis][i] = component(slabs.far, axis);
    }
    p->best_t[i] = best.t;
    p->best_u[i] = best.u;
    p->best_v[i] = best.v;
    p->best_primitive[i] = best.primitive;
    p->farthest = fmax(p->farthest, best.t);
    p->lower_origin = fmin(p->lower_origin, origin);
    p->upper_origin = fmax(p->upper_origin, origin);
    p->lower_inverse = fmin(p->lower_inverse, slabs.inverse);
    p->upper_inverse = fmax(p->upper_inverse, slabs.inverse);
    // near and far are an error of three roundings apart from the middle, each rounded once more; planes add two.
    p->margin = fmax(p->margin, 2.0f * (slabs.far - slabs.near));
}

/// Fills the places of missing rays: call after the last packet_add().
static inline void packet_fill(Packet* p) {
    for (uint i = p->count; i < CHUNK; ++i) {
        for (uint axis = 0; axis < 3; ++axis) {
            p->origin[axis][i] = p->origin[axis][0];
            p->shear[axis][i] = p->shear[axis][0];
            p->inverse[axis][i] = p->inverse[axis][0];
            p->near[axis][i] = p->near[axis][0];
            p->far[axis][i] = p->far[axis][0];
        }
        p->best_t[i] = -1.0f;
        p->best_primitive[i] = NO_INDEX;
    }
}

/// What ray i has found.
static inline Hit packet_hit(const Packet* p, uint i) {
    const Hit hit = {p->best_t[i], p->best_u[i], p->best_v[i], p->best_primitive[i]};
    return hit;
}

static inline float16 min16(float16 a, float16 b) { return select(b, a, a < b); }
static inline float16 max16(float16 a, float16 b) { return select(b, a, a > b); }

static inline uint lane_mask16(int16 comparison) {
    return lane_mask(comparison.lo) | lane_mask(comparison.hi) << 8;
}

static inline bool any16(int16 comparison) {
    const ulong2 bytes = as_ulong2(convert_char16(comparison));
    return (bytes.x | bytes.y) != 0;
}

/// Distances at which the packet's first ray can enter (near = 1) or its last ray can leave (near = 0) the eight slabs.
static inline float8 interval(const Packet* p, global const BvhNode* node, uint axis, uint near) {
    const bool upper = (p->sign[axis] != 0) == (near != 0);  // which plane comes first depends on the sign
    const float origin = component(upper ? p->lower_origin : p->upper_origin, axis);
    const float8 distance = vload8(0, node->bounds[upper ? 1 : 0][axis]) - origin;
    const float8 a = distance * component(p->lower_inverse, axis), b = distance * component(p->upper_inverse, axis);
    const float margin = component(p->margin, axis);
    return near ? min8(a, b) - margin : max8(a, b) + margin;
}

/// Children that some ray of the packet may meet, and where the first ray can enter them.
static inline uint interval_children(const Packet* p, global const BvhNode* node, float8* entry) {
    const float8 enter = max8(max8(interval(p, node, 0, 1), interval(p, node, 1, 1)),
                              max8(interval(p, node, 2, 1), (float8)(0.0f)));
    const float8 leave = min8(min8(interval(p, node, 0, 0), interval(p, node, 1, 0)),
                              min8(interval(p, node, 2, 0), (float8)(p->farthest)));
    // No later than group_meets() and enter_triangle_group() say for any ray: those have the margin, and these 4 roundings.
    *entry = enter * (1.0f - 4.0f * ROUNDING);
    return lane_mask(*entry <= leave * (1.0f + 8.0f * ROUNDING));
}

/// Whether a ray of the group meets child `lane`.
static inline bool group_meets(const Packet* p, global const BvhNode* node, uint lane, uint group) {
    float16 enter = (float16)(0.0f), leave = vload16(group, p->best_t);
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 inverse = vload16(group, p->inverse[axis]);
        const float16 near = vload16(group, p->near[axis]), far = vload16(group, p->far[axis]);
        enter = max16(fma((float16)(node->bounds[p->sign[axis]][axis][lane]), inverse, near), enter);
        leave = min16(fma((float16)(node->bounds[1 - p->sign[axis]][axis][lane]), inverse, far), leave);
    }
    return any16(enter <= leave * (1.0f + 8.0f * ROUNDING));
}

/// Where the rays of a group enter the bounds of one triangle: enter_triangles() in triangle.h.
static inline float16 enter_triangle_group(const Packet* p, global const TriangleBlock* block, uint lane, uint group) {
    float16 enter = (float16)(0.0f);
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 inverse = vload16(group, p->inverse[axis]), near = vload16(group, p->near[axis]);
        const float16 a = fma((float16)(block->position[0][axis][lane]), inverse, near);
        const float16 b = fma((float16)(block->position[1][axis][lane]), inverse, near);
        const float16 c = fma((float16)(block->position[2][axis][lane]), inverse, near);
        enter = max16(min16(min16(a, b), c), enter);
    }
    return enter;
}

/// Rays of a group that hit one triangle nearer than their best so far; replaces it. The arithmetic is that of
/// intersect_triangles() in triangle.h, with rays in the place of triangles.
static inline bool visit_triangle_group(Packet* p, global const TriangleBlock* block, uint lane, uint group,
                                        bool any_hit) {
    const uint x = p->axis[0], y = p->axis[1], z = p->axis[2];
    const float16 origin_x = vload16(group, p->origin[0]), origin_y = vload16(group, p->origin[1]);
    const float16 origin_z = vload16(group, p->origin[2]);
    const float16 shear_x = -vload16(group, p->shear[0]), shear_y = -vload16(group, p->shear[1]);
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
    const float16 shear_z = vload16(group, p->shear[2]);
    const float16 distance = fma(ua, az, fma(va, bz, wa * cz)) * shear_z * inverse;
    const float16 best_t = vload16(group, p->best_t);
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
    hit &= (t < best_t) | ((t == best_t) & (primitive < vload16(group, p->best_primitive)));

    uint on_edge = lane_mask16(hit & ((ua == 0.0f) | (va == 0.0f) | (wa == 0.0f)));
    if (on_edge != 0) {
        float a[2][GROUP], b[2][GROUP], c[2][GROUP];
        int inside[GROUP];
        vstore16(ax, 0, a[0]);
        vstore16(ay, 0, a[1]);
        vstore16(bx, 0, b[0]);
        vstore16(by, 0, b[1]);
        vstore16(cx, 0, c[0]);
        vstore16(cy, 0, c[1]);
        vstore16(hit, 0, inside);
        for (; on_edge != 0; on_edge &= on_edge - 1) {
            const uint ray = lowest_bit(on_edge);
            if (!inside_exactly(a[0][ray], a[1][ray], b[0][ray], b[1][ray], c[0][ray], c[1][ray])) inside[ray] = 0;
        }
        hit = vload16(0, inside);
    }
    if (!any16(hit)) return false;
    vstore16(select(vload16(group, p->best_primitive), (uint16)(primitive), hit), group, p->best_primitive);
    vstore16(select(best_t, any_hit ? (float16)(-1.0f) : t, hit), group, p->best_t);
    vstore16(select(vload16(group, p->best_u), va * inverse, hit), group, p->best_u);
    vstore16(select(vload16(group, p->best_v), wa * inverse, hit), group, p->best_v);
    return true;
}

/// Spheres are tested ray by ray, as alone.
static inline bool visit_spheres_group(Packet* p, global const SphereBlock* block, uint group, bool any_hit,
                                       const float3* origins, const float3* directions) {
    bool found = false;
    for (uint i = group * GROUP; i < (group + 1) * GROUP; ++i) {
        if (p->best_t[i] < 0.0f) continue;
        Query query = {origins[i], directions[i], {0.0f, 0.0f, 0.0f, NO_INDEX}, {p->best_t[i], 0.0f, 0.0f, p->best_primitive[i]}};
        const SlabFrame slabs = slab_frame(origins[i], directions[i]);
        visit_spheres(block, &slabs, &query);
        if (query.best.primitive == p->best_primitive[i]) continue;
        found = true;
        p->best_t[i] = any_hit ? -1.0f : query.best.t;
        p->best_u[i] = 0.0f;
        p->best_v[i] = 0.0f;
        p->best_primitive[i] = query.best.primitive;
    }
    return found;
}

static inline float farthest_best(const Packet* p) {
    float16 t = vload16(0, p->best_t);
    for (uint group = 1; group < GROUPS; ++group) t = max16(t, vload16(group, p->best_t));
    const float8 t8 = max8(t.lo, t.hi);
    const float4 t4 = fmax(t8.lo, t8.hi);
    return fmax(fmax(t4.x, t4.y), fmax(t4.z, t4.w));
}

/// Pushes the children that some group meets, the nearest on top. An entry is that of push_children() in traverse.h with
/// the groups in the four lowest bits of the distance, which only makes it a little smaller.
static inline uint push_groups(const Packet* p, global const BvhNode* node, uint mask, float8 entry8, uint groups,
                               ulong* stack, uint top) {
    float entry[BVH_WIDTH];
    vstore8(entry8, 0, entry);
    const uint bottom = top;
    for (; mask != 0; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        uint meeting = 0;
        for (uint group = 0; group < GROUPS; ++group)
            if ((groups >> group & 1u) && group_meets(p, node, lane, group)) meeting |= 1u << group;
        if (meeting == 0) continue;
        const ulong item = (ulong)((as_uint(entry[lane]) & ~ALL_GROUPS) | meeting) << 32 | node->child[lane];
        uint place = top++;
        for (; place > bottom && stack[place - 1] < item; --place) stack[place] = stack[place - 1];
        stack[place] = item;
    }
    return top;
}

/// Finds the closest hit of every ray of a coherent packet, or with any_hit whether there is one. origins and directions
/// are those of the rays in world space, for what is tested ray by ray.
static void traverse_packet(const Geometry* geometry, Packet* p, bool any_hit, const float3* origins,
                            const float3* directions) {
    if (geometry->node_count == 0) return;
    ulong stack[STACK_SIZE];
    stack[0] = (ulong)ALL_GROUPS << 32;
    uint top = 1;
    while (top > 0) {
        const ulong item = stack[--top];
        const uint groups = (uint)(item >> 32) & ALL_GROUPS;
        if (as_float((uint)(item >> 32) & ~ALL_GROUPS) > p->farthest) continue;
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
            for (uint group = 0; group < GROUPS; ++group) {
                if (!(groups >> group & 1u)) continue;
                if (child & CHILD_SPHERES) {
                    found |= visit_spheres_group(p, geometry->spheres + block, group, any_hit, origins, directions);
                    continue;
                }
                global const TriangleBlock* triangles = geometry->triangles + block;
                for (uint lane = 0; lane < BVH_WIDTH && triangles->primitive[lane] != NO_INDEX; ++lane)
                    found |= visit_triangle_group(p, triangles, lane, group, any_hit);
            }
        if (found) p->farthest = farthest_best(p);
    }
}

#endif
