// One ray against eight spheres.
// Source: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019,
// chapter 7: the discriminant from the perpendicular instead of b^2 - ac.
#ifndef RAYMILL_SPHERE_H
#define RAYMILL_SPHERE_H

#include "lib/triangle.h"

/// Smallest positive distances by lane, and the lanes that hit at a distance in (t_min, t_max].
static inline uint intersect_spheres(global const SphereBlock* block, float3 origin, float3 direction, float t_min,
                                     float t_max, float8* t) {
    const float8 fx = origin.x - vload8(0, block->center[0]);
    const float8 fy = origin.y - vload8(0, block->center[1]);
    const float8 fz = origin.z - vload8(0, block->center[2]);
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

    const float8 root = sqrt(a * max8(discriminant, (float8)(0.0f)));
    const float8 q = b + copysign(root, b);
    const float8 c = fma(fx, fx, fma(fy, fy, fz * fz)) - r2;
    // Of the two roots c / q and q / a the first is the nearer one if b > 0, and negative if the origin is inside (c < 0).
    const float8 t0 = c / q, t1 = q / a;
    const float8 near = min8(t0, t1), far = max8(t0, t1);
    *t = select(far, near, near > t_min);
    return lane_mask(real & (*t > t_min) & (*t <= t_max));
}

#endif
