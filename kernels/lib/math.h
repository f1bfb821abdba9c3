// Arithmetic that gives the same bits wherever and however it is compiled: no contraction, and fma only where it is
// written.
#ifndef RAYMILL_MATH_H
#define RAYMILL_MATH_H

#pragma OPENCL FP_CONTRACT OFF
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#pragma OPENCL EXTENSION cl_khr_int64_extended_atomics : enable

#include "layout.h"

/// For the large functions that kernels call: PoCL compiles what is inlined into a kernel three times, and keeps what
/// lies in it once for each work-item of a group.
#ifdef RAYMILL_PROCESSOR
#define COMPILED_ONCE __attribute__((noinline))
#else
#define COMPILED_ONCE inline
#endif

#define PI 3.14159265358979f
#define ROUNDING 5.9604644775390625e-8f  // 2^-24: half a unit in the last place of 1

static inline float3 load3(global const float* p) { return (float3)(p[0], p[1], p[2]); }
static inline float3 constant3(constant const float* p) { return (float3)(p[0], p[1], p[2]); }

static inline float dot3(float3 a, float3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }

static inline float length3(float3 v) { return sqrt(dot3(v, v)); }

/// Unit vector along v; v must not be zero.
static inline float3 unit3(float3 v) { return v / length3(v); }

/// Component by component; a NaN in a is passed over. Written so that it compiles to one instruction.
static inline float8 min8(float8 a, float8 b) { return select(b, a, a < b); }
static inline float8 max8(float8 a, float8 b) { return select(b, a, a > b); }

static inline float16 min16(float16 a, float16 b) { return select(b, a, a < b); }
static inline float16 max16(float16 a, float16 b) { return select(b, a, a > b); }

/// One bit a lane of a comparison's result.
static inline uint lane_mask(int8 comparison) {
#ifdef __AVX__
    return (uint)__builtin_ia32_movmskps256(as_float8(comparison));
#else
    // Gathers the eight lowest bits of eight bytes into one byte.
    const ulong bytes = as_ulong(convert_char8(comparison)) & 0x0101010101010101ul;
    return (uint)((bytes * 0x0102040810204080ul) >> 56);
#endif
}

/// One bit a lane, as lane_mask() does for eight.
static inline uint lane_mask16(int16 comparison) {
#ifdef __AVX512DQ__
    return (uint)__builtin_ia32_cvtd2mask512(comparison);
#else
    const ulong2 bytes = as_ulong2(convert_char16(comparison)) & 0x0101010101010101ul;
    const ulong2 masks = bytes * 0x0102040810204080ul >> 56;
    return (uint)(masks.x | masks.y << 8);
#endif
}

/// Whether the comparison holds in some lane.
static inline bool any16(int16 comparison) {
#ifdef __AVX512DQ__
    return lane_mask16(comparison) != 0;
#else
    const ulong2 bytes = as_ulong2(convert_char16(comparison));
    return (bytes.x | bytes.y) != 0;
#endif
}

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

/// s * a + b, each component fused.
static inline float3 fma3(float s, float3 a, float3 b) { return fma((float3)(s), a, b); }

#endif
