// Sixteen items side by side: one vector instruction works on all of them. A lane gets the same bits as its item would
// alone, since each operation is rounded by itself; where items differ in what they need, both are computed and one is
// selected. OpenCL's own float3 fills three of a vector's sixteen places. Elementary functions are our own, because a
// library's differ between its scalar and its vectorised form.
#ifndef RAYMILL_LANES_H
#define RAYMILL_LANES_H

#include "lib/math.h"

#define LANES 16

/// The first `count` lanes, one bit each.
static inline uint first_lanes(uint count) { return (1u << count) - 1u; }

/// A point, direction or colour for each lane.
typedef struct {
    float16 x, y, z;
} Lanes3;

static inline Lanes3 lanes_of(float3 v) {
    const Lanes3 r = {(float16)(v.x), (float16)(v.y), (float16)(v.z)};
    return r;
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
static inline Lanes3 lanes_cross(Lanes3 a, Lanes3 b) {
    const Lanes3 r = {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
    return r;
}
static inline float16 lanes_dot(Lanes3 a, Lanes3 b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
static inline float16 lanes_length(Lanes3 v) {
    return sqrt(lanes_dot(v, v));
}
/// By one reciprocal, a rounding more than three divisions have.
static inline Lanes3 lanes_unit(Lanes3 v) {
    return lanes_scale(v, 1.0f / lanes_length(v));
}
static inline int16 lanes_any(Lanes3 v) {
    return (v.x != 0.0f) | (v.y != 0.0f) | (v.z != 0.0f);
}

static inline float16 lanes_max(Lanes3 v) {
    return max16(max16(v.x, v.y), v.z);
}
/// Largest size of a coordinate.
static inline float16 lanes_max_abs(Lanes3 v) {
    return max16(max16(fabs(v.x), fabs(v.y)), fabs(v.z));
}

/// max(x, 0); 0 for NaN.
static inline float16 positive16(float16 x) {
    return select((float16)(0.0f), x, x > 0.0f);
}

/// 2^y within 2 units in the last place; 0 below the smallest normal number. y <= 127.
static inline float16 lanes_exp2(float16 y) {
    const float16 whole = rint(y);
    const float16 f = (y - whole) * 0.693147180559945f;
    // Taylor series of exp on [-ln2/2, ln2/2]; the first term left out is below 6e-9.
    float16 p = (float16)(1.0f / 5040.0f);
    p = fma(p, f, (float16)(1.0f / 720.0f));
    p = fma(p, f, (float16)(1.0f / 120.0f));
    p = fma(p, f, (float16)(1.0f / 24.0f));
    p = fma(p, f, (float16)(1.0f / 6.0f));
    p = fma(p, f, (float16)(0.5f));
    p = fma(p, f, (float16)(1.0f));
    p = fma(p, f, (float16)(1.0f));
    const int16 tiny = y < -126.0f;
    const int16 exponent = convert_int16(select(whole, (float16)(0.0f), tiny));
    return select(p * as_float16((exponent + 127) << 23), (float16)(0.0f), tiny);
}

/// log2(x) for normal x > 0, within 3 units in the last place also near x = 1.
static inline float16 lanes_log2(float16 x) {
    // x = 2^e m with m in [sqrt(1/2), sqrt(2)).
    const int16 shifted = as_int16(x) - 0x3f3504f3;
    const int16 e = shifted >> 23;
    const float16 m = as_float16((shifted & 0x007fffff) + 0x3f3504f3);
    // ln m = 2 atanh(s), s = (m - 1) / (m + 1), |s| < 0.172; the first term left out is below 2e-9 of the sum.
    const float16 s = (m - 1.0f) / (m + 1.0f);
    const float16 s2 = s * s;
    float16 p = (float16)(1.0f / 9.0f);
    p = fma(p, s2, (float16)(1.0f / 7.0f));
    p = fma(p, s2, (float16)(1.0f / 5.0f));
    p = fma(p, s2, (float16)(1.0f / 3.0f));
    const float16 atanh_s = fma(p * s2, s, s);
    return fma(atanh_s, (float16)(2.88539008177793f), convert_float16(e));
}

/// base^exponent for base >= 0 and exponent >= 0; 0^0 = 1. Relative error below (4 + 4 |exponent log2(base)|) 2^-24.
static inline float16 lanes_power(float16 base, float16 exponent) {
    const int16 zero = base < 1.17549435e-38f;
    const float16 logarithm = exponent * lanes_log2(select(base, (float16)(1.0f), zero));
    const float16 result = lanes_exp2(min16(logarithm, (float16)(127.0f)));
    return select(select(result, (float16)(0.0f), zero), (float16)(1.0f), exponent == 0.0f);
}

/// exp(-x) for x >= 0.
static inline float16 lanes_exp_minus(float16 x) {
    return lanes_exp2(x * -1.44269504088896f);
}

/// Angles of (x, y) in [-pi, pi]; absolute error below 5e-7. (0, 0) gives 0.
static inline float16 lanes_angle(float16 y, float16 x) {
    const float16 ax = fabs(x), ay = fabs(y);
    const float16 big = max16(ax, ay);
    // atan on [0, 1] by atan(q) = pi/8 + atan((q - k) / (1 + q k)), k = tan(pi/8), then the series on |r| <= 0.4143.
    const float16 q = min16(ax, ay) / big;
    const float16 r = (q - 0.414213562f) / fma(q, (float16)(0.414213562f), (float16)(1.0f));
    const float16 r2 = r * r;
    float16 p = (float16)(1.0f / 13.0f);
    p = fma(p, r2, (float16)(-1.0f / 11.0f));
    p = fma(p, r2, (float16)(1.0f / 9.0f));
    p = fma(p, r2, (float16)(-1.0f / 7.0f));
    p = fma(p, r2, (float16)(1.0f / 5.0f));
    p = fma(p, r2, (float16)(-1.0f / 3.0f));
    float16 angle = 0.392699082f + fma(p * r2, r, r);
    angle = select(angle, 0.5f * PI - angle, ay > ax);
    angle = select(angle, PI - angle, x < 0.0f);
    angle = select(angle, -angle, y < 0.0f);
    return select(angle, (float16)(0.0f), big == 0.0f);
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
