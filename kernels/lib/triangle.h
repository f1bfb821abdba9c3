// One ray against eight triangles: watertight, and each crossing of a closed mesh counted exactly once.
// Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013; the bound on t follows Pharr, Jakob,
// Humphreys, Physically Based Rendering 4e, section 6.8.7.
// Deviations: where an edge function rounds to zero its exact sign decides (Woop falls back to double), and a ray exactly
// on an edge belongs to one of its two triangles by the top-left rule of rasterisers; the shear is a product.
#ifndef RAYMILL_TRIANGLE_H
#define RAYMILL_TRIANGLE_H

#include "lib/slabs.h"

/// The ray's frame: axis z is the largest of the direction's, x and y keep the handedness; shear maps the ray onto z, and
/// is the direction over that axis with two roundings: every triangle meets the same ray, so that nothing leaks.
typedef struct {
    uint x, y, z;
    float origin_x, origin_y, origin_z;
    float shear_x, shear_y, shear_z;
} TriangleFrame;

static inline float component(float3 v, uint axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// The axis along which a direction is longest.
static inline uint largest_axis(float3 direction) {
    const float3 a = fabs(direction);
    return a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
}

/// The axes of the frame of a ray whose largest axis this is; backward: the direction is negative there.
static inline TriangleFrame frame_axes(uint largest, bool backward) {
    TriangleFrame f;
    f.z = largest;
    f.x = f.z == 2 ? 0u : f.z + 1;
    f.y = f.x == 2 ? 0u : f.x + 1;
    if (backward) {
        const uint swap = f.x;
        f.x = f.y;
        f.y = swap;
    }
    return f;
}

static inline TriangleFrame triangle_frame(float3 origin, float3 direction) {
    const uint largest = largest_axis(direction);
    const float along = component(direction, largest);
    TriangleFrame f = frame_axes(largest, along < 0.0f);
    f.origin_x = component(origin, f.x);
    f.origin_y = component(origin, f.y);
    f.origin_z = component(origin, f.z);
    f.shear_z = 1.0f / along;
    f.shear_x = component(direction, f.x) * f.shear_z;
    f.shear_y = component(direction, f.y) * f.shear_z;
    return f;
}

/// Sign of ax * by - ay * bx without rounding: -1, 0 or 1 (no underflow assumed).
static inline int cross_sign(float ax, float ay, float bx, float by) {
    const float p = ax * by, q = ay * bx;
    if (p != q) return p > q ? 1 : -1;
    const float p_rest = fma(ax, by, -p), q_rest = fma(ay, bx, -q);
    return p_rest > q_rest ? 1 : p_rest < q_rest ? -1 : 0;
}

/// Whether a ray exactly on the directed edge from (ax, ay) to (bx, by) of a triangle with this facing is its own.
static inline bool owns_edge(float ax, float ay, float bx, float by, int facing) {
    const float dy = by - ay, dx = bx - ax;
    return facing > 0 ? (dy > 0.0f || (dy == 0.0f && dx > 0.0f)) : (dy < 0.0f || (dy == 0.0f && dx < 0.0f));
}

/// Whether the origin lies in the triangle a, b, c of the plane, decided exactly; a point on an edge that two triangles
/// share lies in one of them. Rarely asked, but inline all the same: around a call, no vector stays in its register.
static inline __attribute__((always_inline)) bool inside_exactly(float ax, float ay, float bx, float by, float cx,
                                                                 float cy) {
    const int u = cross_sign(cx, cy, bx, by);
    const int v = cross_sign(ax, ay, cx, cy);
    const int w = cross_sign(bx, by, ax, ay);
    const bool negative = u < 0 || v < 0 || w < 0, positive = u > 0 || v > 0 || w > 0;
    if (negative == positive) return false;  // outside, or all zero: seen edge on
    const int facing = positive ? 1 : -1;
    return (u != 0 || owns_edge(bx, by, cx, cy, facing)) && (v != 0 || owns_edge(cx, cy, ax, ay, facing)) &&
           (w != 0 || owns_edge(ax, ay, bx, by, facing));
}

/// Where the ray enters the bounds of each of the block's triangles. A box around them is entered no later, by the same
/// arithmetic: rounding is monotonic.
static inline float8 enter_triangles(global const TriangleBlock* block, const SlabFrame* slabs) {
    global const float* p = &block->position[0][0][0];
    const float inverse[3] = {slabs->inverse.x, slabs->inverse.y, slabs->inverse.z};
    const float near[3] = {slabs->near.x, slabs->near.y, slabs->near.z};
    float8 enter = (float8)(0.0f);
#pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float8 a = fma(aligned8(p + axis * BVH_WIDTH), (float8)(inverse[axis]), (float8)(near[axis]));
        const float8 b = fma(aligned8(p + (3 + axis) * BVH_WIDTH), (float8)(inverse[axis]), (float8)(near[axis]));
        const float8 c = fma(aligned8(p + (6 + axis) * BVH_WIDTH), (float8)(inverse[axis]), (float8)(near[axis]));
        enter = max8(min8(min8(a, b), c), enter);
    }
    return enter;
}

/// Hits of the block's triangles: distance and barycentric weights of vertices 1 and 2 by lane. The mask says which lanes
/// hit at a distance in (0, t_max] that is certainly positive. Inline wherever it is asked for: a frame that is passed by
/// value is written in words and read as vectors, which wait for the words to leave the store buffer.
static inline __attribute__((always_inline)) uint intersect_triangles(global const TriangleBlock* block,
                                                                      const SlabFrame* slabs, TriangleFrame f,
                                                                      float t_max, float8* t, float8* u, float8* v) {
    global const float* p = &block->position[0][0][0];
    global const float *x = p + f.x * BVH_WIDTH, *y = p + f.y * BVH_WIDTH, *z = p + f.z * BVH_WIDTH;
    const float8 az = aligned8(z) - f.origin_z;
    const float8 bz = aligned8(z + 3 * BVH_WIDTH) - f.origin_z;
    const float8 cz = aligned8(z + 6 * BVH_WIDTH) - f.origin_z;
    const float8 ax = fma((float8)(-f.shear_x), az, aligned8(x) - f.origin_x);
    const float8 ay = fma((float8)(-f.shear_y), az, aligned8(y) - f.origin_y);
    const float8 bx = fma((float8)(-f.shear_x), bz, aligned8(x + 3 * BVH_WIDTH) - f.origin_x);
    const float8 by = fma((float8)(-f.shear_y), bz, aligned8(y + 3 * BVH_WIDTH) - f.origin_y);
    const float8 cx = fma((float8)(-f.shear_x), cz, aligned8(x + 6 * BVH_WIDTH) - f.origin_x);
    const float8 cy = fma((float8)(-f.shear_y), cz, aligned8(y + 6 * BVH_WIDTH) - f.origin_y);

    // Twice the areas opposite each vertex: products rounded alike on both sides of an edge, so the signs agree there.
    const float8 ua = cx * by - cy * bx;
    const float8 va = ax * cy - ay * cx;
    const float8 wa = bx * ay - by * ax;
    const float8 smallest = min8(min8(ua, va), wa), largest = max8(max8(ua, va), wa);
    const float8 det = ua + va + wa;
    const float8 inverse = 1.0f / det;
    const float8 distance = fma(ua, az, fma(va, bz, wa * cz)) * f.shear_z * inverse;
    // One way out, and only here: whether lines pass through triangles is a guess that the processor loses, and whether one
    // is hit within reach a better one.
    const int8 inside = ((smallest >= 0.0f) | (largest <= 0.0f)) & (det != 0.0f);
    uint mask = lane_mask(inside & (distance > 0.0f) & (distance <= t_max));
    if (mask == 0) return 0;

    uint on_edge = mask & lane_mask((ua == 0.0f) | (va == 0.0f) | (wa == 0.0f));
    if (on_edge != 0) {
        float a[2][BVH_WIDTH], b[2][BVH_WIDTH], c[2][BVH_WIDTH];
        vstore8(ax, 0, a[0]);
        vstore8(ay, 0, a[1]);
        vstore8(bx, 0, b[0]);
        vstore8(by, 0, b[1]);
        vstore8(cx, 0, c[0]);
        vstore8(cy, 0, c[1]);
        for (uint lane = 0; lane < BVH_WIDTH; ++lane)
            if ((on_edge >> lane & 1u) &&
                !inside_exactly(a[0][lane], a[1][lane], b[0][lane], b[1][lane], c[0][lane], c[1][lane]))
                mask &= ~(1u << lane);
    }

    // A bound on the rounding error of the distance: a hit nearer than this may as well lie behind the origin.
    const float8 max_x = max8(max8(fabs(ax), fabs(bx)), fabs(cx));
    const float8 max_y = max8(max8(fabs(ay), fabs(by)), fabs(cy));
    const float8 max_z = max8(max8(fabs(az), fabs(bz)), fabs(cz));
    // No edge function is larger than their sum, because they have one sign.
    const float8 delta_e = 2.0f * ROUNDING * fma(12.0f * max_x, max_y, 5.0f * max_z * (max_x + max_y));
    const float8 delta = 3.0f * max_z * fabs(f.shear_z) * fma(delta_e, fabs(inverse), (float8)(6.0f * ROUNDING));
    // No hit before its own bounds are entered: else a box might cull what comes out a rounding error nearer than the box.
    *t = max8(enter_triangles(block, slabs), distance);
    *u = va * inverse;
    *v = wa * inverse;
    return mask & lane_mask((distance > delta) & (*t <= t_max));
}

#endif
