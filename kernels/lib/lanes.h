// Sixteen items side by side: one vector instruction works on all of them. A lane gets the same bits as its item would
// alone, since each operation is rounded by itself; where items differ in what they need, both are computed and one is
// selected. OpenCL's own float3 fills three of a vector's sixteen places.
#ifndef RAYMILL_LANES_H
#define RAYMILL_LANES_H

#include "lib/math.h"

#define LANES 16

/// A point, direction or colour for each lane.
typedef struct {
    float16 x, y, z;
} Lanes3;

static inline Lanes3 lanes_of(float3 v) {
    const Lanes3 r = {(float16)(v.x), (float16)(v.y), (float16)(v.z)};
    return r;
}
static inline Lanes3 lanes_load(const float (*p)[LANES]) {
    const Lanes3 r = {vload16(0, p[0]), vload16(0, p[1]), vload16(0, p[2])};
    return r;
}
static inline void lanes_store(float (*p)[LANES], Lanes3 v) {
    vstore16(v.x, 0, p[0]);
    vstore16(v.y, 0, p[1]);
    vstore16(v.z, 0, p[2]);
}
/// Writes v into one lane, and reads it.
static inline void lane_put(float (*p)[LANES], uint lane, float3 v) {
    p[0][lane] = v.x;
    p[1][lane] = v.y;
    p[2][lane] = v.z;
}
static inline float3 lane_get(const float (*p)[LANES], uint lane) {
    return (float3)(p[0][lane], p[1][lane], p[2][lane]);
}

static inline Lanes3 lanes_minus(Lanes3 a) {
    const Lanes3 r = {-a.x, -a.y, -a.z};
    return r;
}
static inline Lanes3 lanes_add(Lanes3 a, Lanes3 b) {
    const Lanes3 r = {a.x + b.x, a.y + b.y, a.z + b.z};
    return r;
}
static inline Lanes3 lanes_sub(Lanes3 a, Lanes3 b) {
    const Lanes3 r = {a.x - b.x, a.y - b.y, a.z - b.z};
    return r;
}
static inline Lanes3 lanes_mul(Lanes3 a, Lanes3 b) {
    const Lanes3 r = {a.x * b.x, a.y * b.y, a.z * b.z};
    return r;
}
static inline Lanes3 lanes_scale(Lanes3 a, float16 s) {
    const Lanes3 r = {a.x * s, a.y * s, a.z * s};
    return r;
}
static inline Lanes3 lanes_div(Lanes3 a, float16 s) {
    const Lanes3 r = {a.x / s, a.y / s, a.z / s};
    return r;
}
/// s * a + b, fused.
static inline Lanes3 lanes_fma(float16 s, Lanes3 a, Lanes3 b) {
    const Lanes3 r = {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)};
    return r;
}
/// b where `where` is true (all bits set), else a: in the order of OpenCL's select().
static inline Lanes3 lanes_select(Lanes3 a, Lanes3 b, int16 where) {
    const Lanes3 r = {select(a.x, b.x, where), select(a.y, b.y, where), select(a.z, b.z, where)};
    return r;
}
static inline float16 lanes_dot(Lanes3 a, Lanes3 b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
static inline float16 lanes_length(Lanes3 v) {
    return sqrt(lanes_dot(v, v));
}
static inline Lanes3 lanes_unit(Lanes3 v) {
    return lanes_div(v, lanes_length(v));
}
static inline int16 lanes_any(Lanes3 v) {
    return (v.x != 0.0f) | (v.y != 0.0f) | (v.z != 0.0f);
}

/// max(x, 0); 0 for NaN.
static inline float16 positive16(float16 x) {
    return select((float16)(0.0f), x, x > 0.0f);
}

/// Cosine and sine of the angle `turns` * 2 pi, for turns in [0, 1]; absolute error below 2e-7.
static inline void lanes_cos_sin(float16 turns, float16* cosine, float16* sine) {
    const int16 quarter =
        convert_int16(fma(turns, (float16)(4.0f), (float16)(0.5f)));             // not negative: truncation is floor
    const float16 a = (turns - convert_float16(quarter) * 0.25f) * (2.0f * PI);  // [-pi/4, pi/4]
    const float16 a2 = a * a;
    float16 s = (float16)(1.0f / 362880.0f);
    s = fma(s, a2, (float16)(-1.0f / 5040.0f));
    s = fma(s, a2, (float16)(1.0f / 120.0f));
    s = fma(s, a2, (float16)(-1.0f / 6.0f));
    s = fma(s * a2, a, a);
    float16 c = (float16)(-1.0f / 3628800.0f);
    c = fma(c, a2, (float16)(1.0f / 40320.0f));
    c = fma(c, a2, (float16)(-1.0f / 720.0f));
    c = fma(c, a2, (float16)(1.0f / 24.0f));
    c = fma(c, a2, (float16)(-0.5f));
    c = fma(c, a2, (float16)(1.0f));
    const int16 q = quarter & 3;
    const int16 swapped = (q & 1) != 0;
    const float16 cos_size = select(c, s, swapped), sin_size = select(s, c, swapped);
    *cosine = select(cos_size, -cos_size, (q == 1) | (q == 2));
    *sine = select(sin_size, -sin_size, q >= 2);
}

/// The unit square to the unit disk, area preserving.
/// Source: Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 1997.
static inline void lanes_disk(float16 square_x, float16 square_y, float16* disk_x, float16* disk_y) {
    const float16 a = fma(square_x, (float16)(2.0f), (float16)(-1.0f));
    const float16 b = fma(square_y, (float16)(2.0f), (float16)(-1.0f));
    const int16 wide = fabs(a) > fabs(b);
    const float16 r = select(b, a, wide);
    // The centre's r is 0, whatever its angle: any number will do for it.
    const float16 ratio = select(select(a, b, wide) / r, (float16)(0.0f), r == 0.0f);
    float16 turns = select((float16)(0.25f) - ratio * 0.125f, ratio * 0.125f, wide);
    turns = select(turns, turns + 1.0f, turns < 0.0f);
    lanes_cos_sin(turns, disk_x, disk_y);
    *disk_x *= r;
    *disk_y *= r;
}

/// Two unit vectors that make a right-handed basis with the unit vector n.
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
static inline void lanes_tangents(Lanes3 n, Lanes3* t, Lanes3* u) {
    const float16 sign = select((float16)(1.0f), (float16)(-1.0f), as_int16(n.z) < 0);
    const float16 a = -1.0f / (sign + n.z);
    const float16 b = n.x * n.y * a;
    t->x = fma(sign * n.x * n.x, a, (float16)(1.0f));
    t->y = sign * b;
    t->z = -sign * n.x;
    u->x = b;
    u->y = fma(n.y * n.y, a, sign);
    u->z = -n.y;
}

#endif
