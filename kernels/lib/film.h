// The film: 64-bit sums in units of 2^-32, FILM_CHANNELS a pixel. Integer addition has no order, so neither the size of a
// queue nor the number of threads can change a bit of the picture.
#ifndef RAYMILL_FILM_H
#define RAYMILL_FILM_H

#include "lib/math.h"

/// Adds one channel. NaN is left out and counted; what is beyond FILM_LIMIT is cut and counted.
static inline void film_add_channel(global long* sum, float value, global Counters* counters) {
    if (value == 0.0f) return;
    if (isnan(value)) {
        atom_inc(&counters->not_a_number);
        return;
    }
    if (fabs(value) > FILM_LIMIT) {
        atom_inc(&counters->saturated);
        value = copysign(FILM_LIMIT, value);
    }
    const long units = (long)rint(value * 4294967296.0f);
    const long before = atom_add(sum, units);
    const long after = (long)((ulong)before + (ulong)units);
    if (((before ^ after) & (units ^ after)) < 0) atom_inc(&counters->saturated);
}

/// Adds radiance to a pixel of the rendered window.
static inline void film_add(global long* film, uint pixel, float3 radiance, global Counters* counters) {
    global long* sum = film + (ulong)pixel * FILM_CHANNELS;
    film_add_channel(sum + 0, radiance.x, counters);
    film_add_channel(sum + 1, radiance.y, counters);
    film_add_channel(sum + 2, radiance.z, counters);
}

/// Counts a camera sample that hit something.
static inline void film_add_coverage(global long* film, uint pixel, global Counters* counters) {
    film_add_channel(film + (ulong)pixel * FILM_CHANNELS + 3, 1.0f, counters);
}

#endif
