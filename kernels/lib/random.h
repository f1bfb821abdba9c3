// Counter-based random numbers: pure functions of integers, never of the slot a ray sits in or of the order of work.
// Compiled by OpenCL C, for sixteen lanes at a time, and by C++, for one: the one thing that the scalar reference shares
// with the kernels.
// Sources: hash, Jarzynski and Olano, "Hash Functions for GPU Rendering" (JCGT 2020), pcg4d;
//          strata, Burley, "Practical Hash-based Owen Scrambling" (JCGT 2020), with the hash of Vegdahl, "Building a
//          Better LK Hash" (2021).
#ifndef RAYMILL_RANDOM_H
#define RAYMILL_RANDOM_H

#ifdef __OPENCL_VERSION__
#define RAYMILL_SHARED static inline
typedef uint16 Word;
#else
#include <cstdint>
#define RAYMILL_SHARED inline
namespace raymill {
using uint = std::uint32_t;
using ulong = std::uint64_t;
using Word = uint;
#endif

// Dimensions: what a random number is for. A light adds its index to RANDOM_LIGHT.
#define RANDOM_PIXEL 0u
#define RANDOM_LENS 1u
#define RANDOM_LIGHT 16u

/// 32 well-mixed bits from four counters (the first word of pcg4d).
RAYMILL_SHARED Word hash4(Word x, Word y, Word z, Word w) {
    x = x * 1664525u + 1013904223u;
    y = y * 1664525u + 1013904223u;
    z = z * 1664525u + 1013904223u;
    w = w * 1664525u + 1013904223u;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    return x ^ w;
}

/// Key of a camera path. pixel = y * width + x in the whole image, so that a crop sees the same numbers.
RAYMILL_SHARED Word path_camera(uint seed, Word pixel) {
    return hash4((Word)(seed), pixel, (Word)(0x51ed270bu), (Word)(0u));
}

/// Key of the path that goes on from `path` by branch 0 (reflection) or 1 (refraction).
RAYMILL_SHARED Word path_child(Word path, uint branch) {
    return hash4(path, (Word)(branch), (Word)(0x9e3779b9u), (Word)(1u));
}

/// Key of one family of stratified samples: those of all the pixel's camera samples for one purpose on one path.
RAYMILL_SHARED Word random_key(Word path, uint dimension) {
    return hash4(path, (Word)(dimension), (Word)(0x85ebca6bu), (Word)(2u));
}

RAYMILL_SHARED Word reverse_bits(Word x) {
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
    return x >> 16 | x << 16;
}

/// Owen scrambling of bits in reversed order: each bit is flipped by a hash of the bits below it (Vegdahl's constants).
RAYMILL_SHARED Word scramble_reversed(Word x, Word key) {
    x ^= x * 0x3d20adeau;
    x += key;
    x *= key >> 16 | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Point `index` of the family's Owen-scrambled (0, 2)-sequence in the unit square, as 24-bit fixed-point coordinates:
/// divide by 2^24 for [0, 1). Of any 2^n points from a multiple of 2^n on, every cell of every grid of 2^n cells (2^n by
/// 1, 2^(n-1) by 2, ...) holds exactly one, and no point depends on how many there are.
RAYMILL_SHARED void stratified_point(Word index, Word key, Word* x, Word* y) {
    const Word shuffled = reverse_bits(scramble_reversed(reverse_bits(index), key));
    // The second generator matrix is Pascal's triangle modulo 2, which factors into five shifts.
    Word second = shuffled;
    second ^= second >> 1 & 0x55555555u;
    second ^= second >> 2 & 0x33333333u;
    second ^= second >> 4 & 0x0f0f0f0fu;
    second ^= second >> 8 & 0x00ff00ffu;
    second ^= second >> 16;
    *x = reverse_bits(scramble_reversed(shuffled, key * 0x9e3779b9u + 0x68bc21ebu)) >> 8;
    *y = reverse_bits(scramble_reversed(second, key * 0x85ebca6bu + 0x02e5be93u)) >> 8;
}

#ifndef __OPENCL_VERSION__
}  // namespace raymill
#endif

#endif
