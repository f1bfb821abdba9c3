// A ray against axis-aligned planes: what boxes cull by, and what keeps each primitive's hits within its own box.
// Source: conservative slabs, Ize, "Robust BVH Ray Traversal", JCGT 2013.
#ifndef RAYMILL_SLABS_H
#define RAYMILL_SLABS_H

#include "lib/math.h"

/// The ray in slab form: plane * inverse + near or far gives the distance, rounded outward by the error of its offset.
typedef struct {
    float3 inverse;
    float3 near, far;
    uint sign[3];  // 1 where the direction is negative: the upper plane comes first
} SlabFrame;

static inline SlabFrame slab_frame(float3 origin, float3 direction) {
    // Directions are unit, so 1e-24 is as good as parallel, and keeps infinity times zero out. A parallel ray stays in the
    // planes that it starts in, for 1e12 units at least, and those nearer to it than 1e-12 count as such.
    const int3 parallel = fabs(direction) < 1e-24f;
    const float3 d = select(direction, copysign((float3)(1e-24f), direction), parallel);
    SlabFrame f;
    f.inverse = 1.0f / d;
    const float3 offset = -origin * f.inverse;
    // Both the product above and the origin's own grid: two roundings, and one to spare.
    const float3 rounding = fabs(offset) * (3.0f * ROUNDING);
    const float3 error = select(rounding, max(rounding, 1e12f), parallel);
    f.near = offset - error;
    f.far = offset + error;
    f.sign[0] = d.x < 0.0f;
    f.sign[1] = d.y < 0.0f;
    f.sign[2] = d.z < 0.0f;
    return f;
}

/// Whether a ray that enters and leaves there meets the box: each distance has 2 roundings, and what lies in the box may
/// have been found off it by 4 roundings of the way there, beside that of the reciprocal, which the shear and the slabs
/// share.
static inline int8 slabs_overlap(float8 enter, float8 leave) { return enter <= leave * (1.0f + 8.0f * ROUNDING); }

#endif
