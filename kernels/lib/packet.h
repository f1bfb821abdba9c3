// A chunk of coherent rays through the hierarchy together: one visit of a node or triangle serves all of them.
// What each ray finds is the same to the last bit as alone: the arithmetic of each test is that of traverse.h, triangle.h
// and sphere.h, sixteen rays against one primitive instead of one ray against eight, and which hit wins does not depend on
// the order.
#ifndef RAYMILL_PACKET_H
#define RAYMILL_PACKET_H

#include "lib/beam.h"
#include "lib/stream.h"

#define ENTRY_GROUPS_SHIFT 3u  // in a stack entry, above the lane

// Directions that differ by more than this on an axis share too few nodes to be worth it.
#define COHERENT_SPREAD 0.4f
#define FEWEST_TOGETHER 24  // rays of a packet, and of those that meet a child: fewer go on as a stream
// Of a pinhole's rays only so few leave the packet, at a leaf, and at once: they go the same way all the same, and at
// most visits it does not pay to count them.
#define FEW_OF_PINHOLE 4

// Children that a stream begins with where any hit will do: with one it would wait for that one's memory. Closest hits
// are looked for at once, since what they find may cull.
#define HANDED_TOGETHER 4

/// A block of triangles as all rays of a packet see it: corners along the axes of its triangle frame, from the origin of a
/// pinhole's rays, and per axis of the world the planes through which rays enter each triangle's bounds.
typedef struct {
    float corner[3][3][BVH_WIDTH];
    float near[3][BVH_WIDTH];
} BlockView;

static inline void view_block(const Packet* p, global const TriangleBlock* block, BlockView* view) {
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float8 a = aligned8(block->position[0][axis]), b = aligned8(block->position[1][axis]);
        const float8 c = aligned8(block->position[2][axis]);
        vstore8(p->sign[axis] ? max8(max8(a, b), c) : min8(min8(a, b), c), 0, view->near[axis]);
    }
    if (!p->is_pinhole) return;
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float origin = p->rays.origin[p->axis[axis]][0].s0;
#pragma unroll
        for (uint corner = 0; corner < 3; ++corner)
            vstore8(aligned8(block->position[corner][p->axis[axis]]) - origin, 0, view->corner[corner][axis]);
    }
}

/// Takes a primitive as the best hit of some rays of a group. With any_hit they are done.
static inline void take_hits(RayChunk* c, uint group, int16 hit, uint primitive, float16 t, float16 u, float16 v,
                             bool any_hit) {
    c->best_primitive[group] = select(c->best_primitive[group], (uint16)(primitive), hit);
    c->best_t[group] = select(c->best_t[group], any_hit ? (float16)(-1.0f) : t, hit);
    c->best_u[group] = select(c->best_u[group], u, hit);
    c->best_v[group] = select(c->best_v[group], v, hit);
}

/// Of the lanes of a comparison, leaves out those on an edge that lie outside: inside_exactly() in triangle.h.
static inline int16 keep_inside(int16 hit, uint on_edge, float16 ax, float16 ay, float16 bx, float16 by, float16 cx,
                                float16 cy) {
    for (; on_edge != 0; on_edge &= on_edge - 1) {
        const uint ray = lowest_bit(on_edge);
        if (!inside_exactly(get_lane(&ax, ray), get_lane(&ay, ray), get_lane(&bx, ray), get_lane(&by, ray),
                            get_lane(&cx, ray), get_lane(&cy, ray)))
            ((int*)&hit)[ray] = 0;
    }
    return hit;
}

/// A triangle as the rays of a group see it: corners in their frames, twice the areas opposite each, the sum of these,
/// and the distance times that sum.
typedef struct {
    float16 ax, ay, az, bx, by, bz, cx, cy, cz;
    float16 ua, va, wa, det, scaled;
} GroupTriangle;

/// Finds out which rays of a group have a line through a triangle. The arithmetic is that of intersect_triangles() in
/// triangle.h, with rays in the place of triangles. With any_hit those are left out that have it behind them, as the
/// surface often is which a shadow ray starts on.
static inline __attribute__((always_inline)) int16 pass_through(const Packet* p, global const TriangleBlock* block,
                                                                const BlockView* view, uint lane, uint group,
                                                                bool any_hit, GroupTriangle* g) {
    const RayChunk* c = &p->rays;
    const float16 shear_x = -c->shear[0][group], shear_y = -c->shear[1][group];
    if (p->is_pinhole) {
        g->az = view->corner[0][2][lane];
        g->bz = view->corner[1][2][lane];
        g->cz = view->corner[2][2][lane];
        g->ax = fma(shear_x, g->az, (float16)(view->corner[0][0][lane]));
        g->ay = fma(shear_y, g->az, (float16)(view->corner[0][1][lane]));
        g->bx = fma(shear_x, g->bz, (float16)(view->corner[1][0][lane]));
        g->by = fma(shear_y, g->bz, (float16)(view->corner[1][1][lane]));
        g->cx = fma(shear_x, g->cz, (float16)(view->corner[2][0][lane]));
        g->cy = fma(shear_y, g->cz, (float16)(view->corner[2][1][lane]));
    } else {
        const uint x = p->axis[0], y = p->axis[1], z = p->axis[2];
        const float16 origin_x = c->origin[x][group], origin_y = c->origin[y][group], origin_z = c->origin[z][group];
        g->az = block->position[0][z][lane] - origin_z;
        g->bz = block->position[1][z][lane] - origin_z;
        g->cz = block->position[2][z][lane] - origin_z;
        g->ax = fma(shear_x, g->az, block->position[0][x][lane] - origin_x);
        g->ay = fma(shear_y, g->az, block->position[0][y][lane] - origin_y);
        g->bx = fma(shear_x, g->bz, block->position[1][x][lane] - origin_x);
        g->by = fma(shear_y, g->bz, block->position[1][y][lane] - origin_y);
        g->cx = fma(shear_x, g->cz, block->position[2][x][lane] - origin_x);
        g->cy = fma(shear_y, g->cz, block->position[2][y][lane] - origin_y);
    }
    g->ua = g->cx * g->by - g->cy * g->bx;
    g->va = g->ax * g->cy - g->ay * g->cx;
    g->wa = g->bx * g->ay - g->by * g->ax;
    g->det = g->ua + g->va + g->wa;
    g->scaled = fma(g->ua, g->az, fma(g->va, g->bz, g->wa * g->cz)) * c->shear[2][group];
    const float16 smallest = min16(min16(g->ua, g->va), g->wa), largest = max16(max16(g->ua, g->va), g->wa);
    int16 through = (smallest >= 0.0f) | (largest <= 0.0f);
    if (any_hit) through &= (as_int16(g->scaled) ^ as_int16(g->det)) >= 0;
    return through;
}

/// Rays of a group that hit one triangle nearer than their best so far; replaces it.
static inline bool visit_triangle_group(Packet* p, global const TriangleBlock* block, const BlockView* view, uint lane,
                                        uint group, bool any_hit) {
    RayChunk* c = &p->rays;
    GroupTriangle g;
    int16 hit = pass_through(p, block, view, lane, group, any_hit, &g);
    // Behind the ray: not worth the division.
    hit &= (as_int16(g.scaled) ^ as_int16(g.det)) >= 0;
    if (!any16(hit)) return false;

    const float16 inverse = 1.0f / g.det;
    const float16 distance = g.scaled * inverse;
    const float16 best_t = c->best_t[group];
    hit &= (distance <= best_t) & (g.det != 0.0f);
    if (!any16(hit)) return false;

    const float16 x16 = max16(max16(fabs(g.ax), fabs(g.bx)), fabs(g.cx));
    const float16 y16 = max16(max16(fabs(g.ay), fabs(g.by)), fabs(g.cy));
    const float16 z16 = max16(max16(fabs(g.az), fabs(g.bz)), fabs(g.cz));
    const float16 delta_e = 2.0f * ROUNDING * fma(12.0f * x16, y16, 5.0f * z16 * (x16 + y16));
    const float16 delta =
        3.0f * z16 * fabs(c->shear[2][group]) * fma(delta_e, fabs(inverse), (float16)(6.0f * ROUNDING));
    hit &= distance > delta;
    float16 t = distance;
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis)
        t = max16(fma((float16)(view->near[axis][lane]), c->inverse[axis][group], c->near[axis][group]), t);
    const uint primitive = block->primitive[lane];
    hit &= (t < best_t) | ((t == best_t) & (primitive < c->best_primitive[group]));

    const int16 on_edge = hit & ((g.ua == 0.0f) | (g.va == 0.0f) | (g.wa == 0.0f));
    if (any16(on_edge)) hit = keep_inside(hit, lane_mask16(on_edge), g.ax, g.ay, g.bx, g.by, g.cx, g.cy);
    if (!any16(hit)) return false;
    take_hits(c, group, hit, primitive, t, g.va * inverse, g.wa * inverse, any_hit);
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

/// Pushes the children that some group meets, with the rays that meet them, the nearest on top. An entry is that of
/// push_children() in traverse.h with the groups in the next four bits of the distance, which only makes it a little
/// smaller.
static inline uint push_groups(const Geometry* geometry, global const uint* children, uint mask, float8 entry,
                               const ulong* rays, ulong* stack, ulong* stack_rays, uint top) {
    uint met = (mask | mask >> 16) & 0xffffu;
    met = (met | met >> 8) & 0xffu;
    if (met == 0) return top;
    uint key[BVH_WIDTH], place[BVH_WIDTH];
    const uint8 key8 = as_uint8(entry) & ~(7u | ALL_GROUPS << ENTRY_GROUPS_SHIFT);
    vstore8(key8, 0, key);
    vstore8(places_by_distance(key8, met), 0, place);
    const uint count = popcount(met);
    for (; met != 0; met &= met - 1) {
        const uint lane = lowest_bit(met);
        const uint groups = groups_of_box(mask, lane);
        stack[top + place[lane]] = (ulong)(key[lane] | groups << ENTRY_GROUPS_SHIFT) << 32 | children[lane];
        stack_rays[top + place[lane]] = rays[lane];
        prefetch_child(geometry, children[lane]);
    }
    return top + count;
}

/// Boxes that one group alone meets, one bit each.
static inline uint boxes_of_one_group(uint mask) {
    const uint either = mask | mask >> 16, both = mask & mask >> 16;
    const uint any = either | either >> 8, several = both | both >> 8 | (either & either >> 8);
    return any & ~several & 0xffu;
}

/// Children that are leaves, one bit each.
static inline uint leaves_of(global const BvhNode* node) {
    return lane_mask(as_int8(aligned8((global const float*)node->child)) < 0);
}

/// Finds which rays meet each child, and leaves out the groups that none of meets it. Of a pinhole's rays all may, but
/// at leaves that one group alone meets.
static inline uint rays_meeting_children(const Packet* p, global const BvhNode* node, uint mask, ulong* rays) {
    uint counted = 0xffu;
    vstore8((ulong8)(p->is_pinhole ? ~0ul : 0ul), 0, rays);
    if (p->is_pinhole) {
        counted = boxes_of_one_group(mask) & leaves_of(node);
        for (uint rest = counted; rest != 0; rest &= rest - 1) rays[lowest_bit(rest)] = 0;
    }
    for (uint rest = mask & counted * 0x01010101u; rest != 0; rest &= rest - 1) {
        const uint bit = lowest_bit(rest), lane = bit % BVH_WIDTH, group = bit / BVH_WIDTH;
        const uint meeting = rays_meeting(p, node, lane, group);
        if (meeting == 0) mask &= ~(1u << bit);
        rays[lane] |= (ulong)meeting << GROUP * group;
    }
    return mask;
}

/// Tests each group's rays against those triangles of a block that its beam meets. First which triangles some line of a
/// group passes through, for all of them without a branch, since no processor foresees it; then the few that are left.
static inline bool visit_triangles_groups(Packet* p, global const TriangleBlock* block, uint groups, bool any_hit) {
    uint meeting = groups_meeting_triangles(p, block) & spread_groups(groups);
    if (meeting == 0) return false;
    BlockView view;
    view_block(p, block, &view);
    uint passing = 0;
    for (; meeting != 0; meeting &= meeting - 1) {
        const uint bit = lowest_bit(meeting);
        GroupTriangle g;
        const int16 through = pass_through(p, block, &view, bit % BVH_WIDTH, bit / BVH_WIDTH, any_hit, &g);
        passing |= (uint)any16(through) << bit;
    }
    bool found = false;
    for (; passing != 0; passing &= passing - 1) {
        const uint bit = lowest_bit(passing);
        found |= visit_triangle_group(p, block, &view, bit % BVH_WIDTH, bit / BVH_WIDTH, any_hit);
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
/// there is one. What few rays meet they visit as a stream.
static void traverse_packet(const Geometry* geometry, Packet* p, bool any_hit) {
    ulong stack[STACK_SIZE], stack_rays[STACK_SIZE];
    stack_rays[0] = ~0ul;
    stack[0] = (ulong)(ALL_GROUPS << ENTRY_GROUPS_SHIFT) << 32;
    uint top = 1;
    Sharing sharing = {0, 0};
    Visit handed[AHEAD_FOR_ANY];
    uint count = 0;
    while (top > 0) {
        chunk_ask_ahead(&p->rays, ASKED_A_VISIT);
        const ulong item = stack[--top];
        const uint distance = (uint)(item >> 32), child = (uint)item;
        if (as_float(distance & ~(7u | ALL_GROUPS << ENTRY_GROUPS_SHIFT)) > p->farthest_of_all) continue;
        const ulong rays_here = stack_rays[top];
        if (p->is_pinhole && popcount(rays_here) <= FEW_OF_PINHOLE) {
            if (stream_visit_leaf(&p->rays, geometry, child, rays_here, true, any_hit)) update_farthest(p);
            continue;
        }
        if (!p->is_pinhole && popcount(rays_here) < FEWEST_TOGETHER) {
            handed[count].child = child;
            handed[count].rays = rays_here;
            count += 1;
            if (count < (any_hit ? HANDED_TOGETHER : 1)) continue;
            if (stream_below(geometry, &p->rays, handed, count, any_hit, &sharing)) update_farthest(p);
            count = 0;
            if (any_hit || !share_little(&sharing)) continue;
            fly_rays(geometry, &p->rays, p->rays.rays);
            return;
        }
        const uint groups = distance >> ENTRY_GROUPS_SHIFT & ALL_GROUPS;
        if (!(child & CHILD_LEAF)) {
            global const BvhNode* node = geometry->nodes + child;
            float8 entry;
            ulong rays[BVH_WIDTH];
            uint mask = groups_meeting_children(p, node, &entry) & spread_groups(groups);
            mask = rays_meeting_children(p, node, mask, rays);
            top = push_groups(geometry, node->child, mask, entry, rays, stack, stack_rays, top);
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
    if (count > 0) stream_below(geometry, &p->rays, handed, count, any_hit, &sharing);
}

/// Whether those rays of a chunk that have a bit set, all of one octant, share so much of the hierarchy that they are better
/// traced together.
static inline bool go_together(const RayChunk* c, ulong rays) {
    if (popcount(rays) < FEWEST_TOGETHER) return false;
    for (uint axis = 0; axis < 3; ++axis) {
        float16 lower = (float16)(INFINITY), upper = (float16)(-INFINITY);
#pragma unroll
        for (uint group = 0; group < GROUPS; ++group) {
            const int16 is_in = lanes_of_rays(rays, group);
            lower = select(lower, min16(lower, c->direction[axis][group]), is_in);
            upper = select(upper, max16(upper, c->direction[axis][group]), is_in);
        }
        if (max_lane(upper) - min_lane(lower) > COHERENT_SPREAD) return false;
    }
    return true;
}

static inline void trace_together(const Geometry* geometry, Packet* p, bool any_hit) {
    packet_prepare(p);
    traverse_packet(geometry, p, any_hit);
}

/// Finds the closest hit of every ray of a chunk, or with any_hit whether there is one: rays that go the same way together,
/// all others as streams.
static inline void traverse_chunk(const Geometry* geometry, Packet* p, bool any_hit) {
    RayChunk* c = &p->rays;
    chunk_visit_planes(c, geometry);
    if (any_hit)
        for (uint group = 0; group < GROUPS; ++group)
            c->best_t[group] = select(c->best_t[group], (float16)(-1.0f), c->best_primitive[group] != NO_INDEX);
    if (geometry->node_count == 0) return;
    ulong loose = 0;
    for (ulong waiting = c->rays; waiting != 0;) {
        const ulong members = waiting & rays_of_octant(c, get_octant(c, lowest_bit64(waiting)));
        waiting &= ~members;
        if (!go_together(c, members)) {
            loose |= members;
        } else if (members == c->rays) {
            trace_together(geometry, p, any_hit);
        } else {
            Packet part;
            chunk_part(&part.rays, c, members);
            trace_together(geometry, &part, any_hit);
            chunk_merge(c, &part.rays);
        }
    }
    if (any_hit)
        stream_any_hits(geometry, c, loose);
    else
        stream_closest_hits(geometry, c, loose);
}

#endif
