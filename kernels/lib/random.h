// Counter-based random numbers: pure functions of integers, never of the slot a ray sits in or of the order of work.
// Compiled by OpenCL C and by C++, and the one thing that the scalar reference shares with the kernels.
// Sources: hash, Jarzynski and Olano, "Hash Functions for GPU Rendering" (JCGT 2020), pcg4d;
//          strata, Kensler, "Correlated Multi-Jittered Sampling" (Pixar TM 13-01, 2013).
#ifndef RAYMILL_RANDOM_H
#define RAYMILL_RANDOM_H

#ifdef __OPENCL_VERSION__
#define RAYMILL_SHARED static inline
#else
#include <cstdint>
#define RAYMILL_SHARED inline
namespace raymill {
using uint = std::uint32_t;
using ulong = std::uint64_t;
#endif

// Dimensions: what a random number is for. A light adds its index to RANDOM_LIGHT.
#define RANDOM_PIXEL 0u
#define RANDOM_LENS 1u
#define RANDOM_LIGHT 16u

/// 32 well-mixed bits from four counters (the first word of pcg4d).
RAYMILL_SHARED uint hash4(uint x, uint y, uint z, uint w) {
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
RAYMILL_SHARED uint path_camera(uint seed, uint pixel) { return hash4(seed, pixel, 0x51ed270bu, 0u); }

/// Key of the path that goes on from `path` by branch 0 (reflection) or 1 (refraction).
RAYMILL_SHARED uint path_child(uint path, uint branch) { return hash4(path, branch, 0x9e3779b9u, 1u); }

/// Key of one family of stratified samples: those of all the pixel's camera samples for one purpose on one path.
RAYMILL_SHARED uint random_key(uint path, uint dimension) { return hash4(path, dimension, 0x85ebca6bu, 2u); }

/// A random permutation of [0, length) chosen by key, evaluated at i (Kensler, listing 3).
RAYMILL_SHARED uint permute(uint i, uint length, uint key) {
    uint w = length - 1u;
    w |= w >> 1;
    w |= w >> 2;
    w |= w >> 4;
    w |= w >> 8;
    w |= w >> 16;
    do {
        i ^= key;
        i *= 0xe170893du;
        i ^= key >> 16;
        i ^= (i & w) >> 4;
        i ^= key >> 8;
        i *= 0x0929eb3fu;
        i ^= key >> 23;
        i ^= (i & w) >> 1;
        i *= 1u | key >> 27;
        i *= 0x6935fa69u;
        i ^= (i & w) >> 11;
        i *= 0x74dcb303u;
        i ^= (i & w) >> 2;
        i *= 0x9e501cc3u;
        i ^= (i & w) >> 2;
        i *= 0xc860a3dfu;
        i &= w;
        i ^= i >> 5;
    } while (i >= length);
    return (i + key) % length;
}

/// Number of columns of the grid that stratifies `count` samples: the largest divisor not above its square root gives
/// the rows, so that every cell holds exactly one sample. count >= 1.
RAYMILL_SHARED uint strata_columns(uint count) {
    uint rows = 1u;
    for (uint k = 2u; k * k <= count; ++k)
        if (count % k == 0u) rows = k;
    return count / rows;
}

/// Sample `index` of `count` correlated multi-jittered points in the unit square, as 24-bit fixed-point coordinates:
/// divide by 2^24 for [0, 1). Every column of the fine grid (count by count) and every coarse cell
/// (columns by count / columns) holds exactly one point, up to the 24 bits. columns = strata_columns(count).
RAYMILL_SHARED void stratified_point(uint index, uint count, uint columns, uint key, uint* x, uint* y) {
    const uint rows = count / columns;
    const uint s = permute(index % count, count, key * 0x51633e2du);
    const uint column = s % columns;
    const uint row = s / columns;
    const uint shuffled_column = permute(column, columns, key * 0x68bc21ebu);
    const uint shuffled_row = permute(row, rows, key * 0x02e5be93u);
    const uint jitter_x = hash4(s, key, 0x967a889bu, 0u) >> 8;
    const uint jitter_y = hash4(s, key, 0x368cc8b7u, 0u) >> 8;
    // The coarse cell is (column, row); shuffling the other coordinate picks the fine column and row inside it.
    *x = (uint)((((ulong)(column * rows + shuffled_row) << 24) + jitter_x) / count);
    *y = (uint)((((ulong)(row * columns + shuffled_column) << 24) + jitter_y) / count);
}

#ifndef __OPENCL_VERSION__
}  // namespace raymill
#endif

#endif
