// One ray against eight spheres.
// Source: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019,
// chapter 7: the discriminant from the perpendicular instead of b^2 - ac.
#ifndef RAYMILL_SPHERE_H
#define RAYMILL_SPHERE_H

#include "lib/triangle.h"

/// Where the ray enters and leaves the bounds of the block's spheres along one axis.
static inline void clip_axis(float8 center, float8 radius, float inverse, float near, float far, float8* enter,
                             float8* leave) {
    const float8 along = copysign(radius, (float8)(inverse));
    *enter = max8(fma(center - along, (float8)(inverse), (float8)(near)), *enter);
    *leave = min8(fma(center + along, (float8)(inverse), (float8)(far)), *leave);
}

/// The next hits after `after` in the order of distance and id: distances by lane, and the lanes that hit up to t_max.
/// A ray must meet a sphere's own bounds, and meets it no earlier: else a box might cull what rounding puts beside it.
/// Inline since frames are written in words and read as vectors (triangle.h).
static inline __attribute__((always_inline)) uint intersect_spheres(global const SphereBlock* block,
                                                                    const SlabFrame* slabs, float3 origin,
                                                                    float3 direction, Hit after, float t_max,
                                                                    float8* t) {
    const float8 cx = vload8(0, block->center[0]), cy = vload8(0, block->center[1]), cz = vload8(0, block->center[2]);
    const float8 fx = origin.x - cx, fy = origin.y - cy, fz = origin.z - cz;
    const float8 r = vload8(0, block->radius);
    const float8 dx = direction.x, dy = direction.y, dz = direction.z;

    const float a = dot3(direction, direction);
    const float8 b = -fma(fx, dx, fma(fy, dy, fz * dz));
    const float8 along = b / a;
    const float8 px = fma(along, dx, fx), py = fma(along, dy, fy), pz = fma(along, dz, fz);
    const float8 r2 = r * r;
    const float8 discriminant = r2 - fma(px, px, fma(py, py, pz * pz));
    const int8 real = (discriminant >= 0.0f) & (r > 0.0f);
    if (lane_mask(real) == 0) return 0;

    float8 enter = (float8)(0.0f), leave = (float8)(INFINITY);
    clip_axis(cx, r, slabs->inverse.x, slabs->near.x, slabs->far.x, &enter, &leave);
    clip_axis(cy, r, slabs->inverse.y, slabs->near.y, slabs->far.y, &enter, &leave);
    clip_axis(cz, r, slabs->inverse.z, slabs->near.z, slabs->far.z, &enter, &leave);

    const float8 root = sqrt(a * max8(discriminant, (float8)(0.0f)));
    const float8 q = b + copysign(root, b);
    const float8 c = fma(fx, fx, fma(fy, fy, fz * fz)) - r2;
    // Of the two roots c / q and q / a the first is the nearer one if b > 0, and negative if the origin is inside (c < 0).
    const float8 t0 = c / q, t1 = q / a;
    const float8 near = min8(t0, t1), far = max8(t0, t1);
    const float8 entry = select(near, max8(enter, near), near > 0.0f), exit = max8(enter, far);
    // Of spheres at the same distance those of higher ids are still to come; of one sphere, only its other end.
    const int8 is_higher = vload8(0, block->primitive) > after.primitive;
    const int8 entry_counts = (entry > 0.0f) & ((entry > after.t) | ((entry == after.t) & is_higher));
    const int8 exit_counts = (far > 0.0f) & ((exit > after.t) | ((exit == after.t) & is_higher));
    *t = select(exit, entry, entry_counts);
    return lane_mask(real & slabs_overlap(enter, leave) & (entry_counts | exit_counts) & (*t <= t_max));
}

#endif
