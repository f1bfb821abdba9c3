// Arithmetic that gives the same bits wherever and however it is compiled: no contraction, fma only where it is written,
// and our own elementary functions, because a library's differ between its scalar and its vectorised form.
#ifndef RAYMILL_MATH_H
#define RAYMILL_MATH_H

#pragma OPENCL FP_CONTRACT OFF
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#pragma OPENCL EXTENSION cl_khr_int64_extended_atomics : enable

#include "layout.h"

#define PI 3.14159265358979f
#define ROUNDING 5.9604644775390625e-8f  // 2^-24: half a unit in the last place of 1

static inline float3 load3(global const float* p) { return (float3)(p[0], p[1], p[2]); }
static inline float3 constant3(constant const float* p) { return (float3)(p[0], p[1], p[2]); }
static inline float3 private3(const float* p) { return (float3)(p[0], p[1], p[2]); }
static inline void store3(global float* p, float3 v) {
    p[0] = v.x;
    p[1] = v.y;
    p[2] = v.z;
}

static inline float dot3(float3 a, float3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }

static inline float3 cross3(float3 a, float3 b) {
    return (float3)(fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x)));
}

static inline float length3(float3 v) { return sqrt(dot3(v, v)); }

/// Unit vector along v; v must not be zero.
static inline float3 unit3(float3 v) { return v / length3(v); }

/// Component by component; a NaN in a is passed over. Written so that it compiles to one instruction.
static inline float8 min8(float8 a, float8 b) { return select(b, a, a < b); }
static inline float8 max8(float8 a, float8 b) { return select(b, a, a > b); }

static inline float16 min16(float16 a, float16 b) { return select(b, a, a < b); }
static inline float16 max16(float16 a, float16 b) { return select(b, a, a > b); }

/// Eight floats at a multiple of 32 bytes: one load, which vload8 is not.
static inline float8 aligned8(global const float* p) { return *(global const float8*)p; }

/// Asks for memory that will be read soon, where there is a way to: PoCL's prefetch() does nothing.
static inline void fetch_early(global const void* address, uint bytes) {
#ifdef __AVX__
#pragma unroll
    for (uint line = 0; line < bytes; line += 64) __builtin_prefetch((const void*)((ulong)address + line));
#endif
}

/// Index of the lowest bit set; mask must not be zero. Compilers know this as one instruction.
static inline uint lowest_bit(uint mask) { return popcount(~mask & (mask - 1u)); }
static inline uint lowest_bit64(ulong mask) { return (uint)popcount(~mask & (mask - 1ul)); }

static inline float max3(float3 v) { return fmax(fmax(v.x, v.y), v.z); }

/// s * a + b, each component fused.
static inline float3 fma3(float s, float3 a, float3 b) { return fma((float3)(s), a, b); }

/// 2^y within 2 units in the last place; 0 below the smallest normal number. y <= 127.
static inline float exp2_exact(float y) {
    if (y < -126.0f) return 0.0f;
    const float whole = rint(y);
    const float f = (y - whole) * 0.693147180559945f;
    // Taylor series of exp on [-ln2/2, ln2/2]; the first term left out is below 6e-9.
    float p = 1.0f / 5040.0f;
    p = fma(p, f, 1.0f / 720.0f);
    p = fma(p, f, 1.0f / 120.0f);
    p = fma(p, f, 1.0f / 24.0f);
    p = fma(p, f, 1.0f / 6.0f);
    p = fma(p, f, 0.5f);
    p = fma(p, f, 1.0f);
    p = fma(p, f, 1.0f);
    return p * as_float(((int)whole + 127) << 23);
}

/// log2(x) for normal x > 0, within 3 units in the last place also near x = 1.
static inline float log2_exact(float x) {
    // x = 2^e m with m in [sqrt(1/2), sqrt(2)).
    const int shifted = as_int(x) - 0x3f3504f3;
    const int e = shifted >> 23;
    const float m = as_float((shifted & 0x007fffff) + 0x3f3504f3);
    // ln m = 2 atanh(s), s = (m - 1) / (m + 1), |s| < 0.172; the first term left out is below 2e-9 of the sum.
    const float s = (m - 1.0f) / (m + 1.0f);
    const float s2 = s * s;
    float p = 1.0f / 9.0f;
    p = fma(p, s2, 1.0f / 7.0f);
    p = fma(p, s2, 1.0f / 5.0f);
    p = fma(p, s2, 1.0f / 3.0f);
    const float atanh_s = fma(p * s2, s, s);
    return fma(atanh_s, 2.88539008177793f, (float)e);
}

/// base^exponent for base >= 0 and exponent >= 0; 0^0 = 1. Relative error below (4 + 4 |exponent log2(base)|) 2^-24.
static inline float power(float base, float exponent) {
    if (exponent == 0.0f) return 1.0f;
    if (base < 1.17549435e-38f) return 0.0f;
    return exp2_exact(fmin(exponent * log2_exact(base), 127.0f));
}

/// exp(-x) for each component, x >= 0.
static inline float3 exp_minus(float3 x) {
    return (float3)(exp2_exact(x.x * -1.44269504088896f), exp2_exact(x.y * -1.44269504088896f),
                    exp2_exact(x.z * -1.44269504088896f));
}

/// Angle of (x, y) in [-pi, pi]; absolute error below 5e-7. (0, 0) gives 0.
static inline float angle_of(float y, float x) {
    const float ax = fabs(x), ay = fabs(y);
    const float big = fmax(ax, ay);
    if (big == 0.0f) return 0.0f;
    // atan on [0, 1] by atan(q) = pi/8 + atan((q - k) / (1 + q k)), k = tan(pi/8), then the series on |r| <= 0.4143.
    const float q = fmin(ax, ay) / big;
    const float r = (q - 0.414213562f) / fma(q, 0.414213562f, 1.0f);
    const float r2 = r * r;
    float p = 1.0f / 13.0f;
    p = fma(p, r2, -1.0f / 11.0f);
    p = fma(p, r2, 1.0f / 9.0f);
    p = fma(p, r2, -1.0f / 7.0f);
    p = fma(p, r2, 1.0f / 5.0f);
    p = fma(p, r2, -1.0f / 3.0f);
    float angle = 0.392699082f + fma(p * r2, r, r);
    if (ay > ax) angle = 0.5f * PI - angle;
    if (x < 0.0f) angle = PI - angle;
    return y < 0.0f ? -angle : angle;
}

#endif
