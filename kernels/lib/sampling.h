// Stratified samples as floats.
#ifndef RAYMILL_SAMPLING_H
#define RAYMILL_SAMPLING_H

#include "lib/lanes.h"
#include "lib/random.h"

/// Point `index` of the stratified points of [0, 1)^2 for one purpose (dimension) of one path: sixteen of them.
static inline void stratified_samples(uint16 index, uint16 path, uint dimension, float16* x, float16* y) {
    uint16 sample_x, sample_y;
    stratified_point(index, random_key(path, dimension), &sample_x, &sample_y);
    *x = convert_float16(as_int16(sample_x)) * 5.9604644775390625e-8f;  // 2^-24
    *y = convert_float16(as_int16(sample_y)) * 5.9604644775390625e-8f;
}

#endif
