// Integer sums to mean radiance.
// Reads:  film.
// Writes: pixels, RGBA.
// Next:   the host reads them.

#include "lib/math.h"

/// One work-item a channel of a pixel.
kernel void resolve(global const long* film, uint count, uint spp, global float* pixels) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    pixels[i] = convert_float_rte(film[i]) * 2.3283064365386963e-10f / (float)spp;  // 2^-32
}
