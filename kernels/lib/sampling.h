// Stratified samples as floats.
#ifndef RAYMILL_SAMPLING_H
#define RAYMILL_SAMPLING_H

#include "lib/lanes.h"
#include "lib/random.h"

/// Point `index` of the stratified points of [0, 1)^2 for one purpose (dimension) of one path: sixteen of them.
static inline void stratified_samples(const uint* index, const uint* path, uint dimension, float16* x, float16* y) {
    float xs[LANES], ys[LANES];
    // Nothing but integers and no branch: the compiler makes vectors of it.
    for (uint lane = 0; lane < LANES; ++lane) {
        uint sample_x, sample_y;
        stratified_point(index[lane], random_key(path[lane], dimension), &sample_x, &sample_y);
        xs[lane] = (float)(int)sample_x;
        ys[lane] = (float)(int)sample_y;
    }
    *x = vload16(0, xs) * 5.9604644775390625e-8f;  // 2^-24
    *y = vload16(0, ys) * 5.9604644775390625e-8f;
}

#endif
