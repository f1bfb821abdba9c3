// Stratified samples as floats.
#ifndef RAYMILL_SAMPLING_H
#define RAYMILL_SAMPLING_H

#include "lib/math.h"
#include "lib/random.h"

/// Point `index` of the stratified points of [0, 1)^2 for one purpose (dimension) of one path.
static inline float2 stratified_sample(uint index, uint path, uint dimension) {
    uint x, y;
    stratified_point(index, random_key(path, dimension), &x, &y);
    return (float2)((float)x, (float)y) * 5.9604644775390625e-8f;  // 2^-24
}

#endif
