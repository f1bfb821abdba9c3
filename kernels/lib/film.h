// The film: 64-bit sums in units of 2^-32, FILM_CHANNELS a pixel and plane. Integer addition has no order, so neither
// the size of a queue nor the number of threads can change a bit of the picture.
#ifndef RAYMILL_FILM_H
#define RAYMILL_FILM_H

#include "lib/gather.h"

typedef struct {
    global long* sums;
    global Counters* counters;
    constant SceneConstants* constants;
    uint flags;         // FILM_PIXELS_ONCE ...
    uint kernel_place;  // in Counters::atomics
} Film;

// What adds returns how many atomic operations it issued; the kernel hands their number to film_count_atomics(). In the
// struct it would lie in memory, and a store between two atomic operations holds them up.

/// Adds to one of the counters that every frame needs, unless there is nothing to add.
static inline uint film_count(global ulong* counter, uint number) {
    if (number == 0) return 0;
    atom_add(counter, (ulong)number);
    return 1;
}

/// Adds to one of those that only the profile needs.
static inline void film_profile(const Film* film, global ulong* counter, uint number) {
    if ((film->flags & FILM_COUNTED) && number != 0) atom_add(counter, (ulong)number);
}

static inline void film_count_atomics(const Film* film, uint number) {
    film_profile(film, film->counters->atomics + film->kernel_place, number);
}

/// The pixel's channels of a plane that is kept.
static inline global long* film_pixel(const Film* film, uint plane, uint pixel) {
    return film->sums + ((ulong)film->constants->plane[plane] * film->constants->film_pixels + pixel) * FILM_CHANNELS;
}

static inline bool film_keeps(const Film* film, uint plane) {
    return film->constants->plane[plane] != 0;
}

/// What is stored of a value that the film does not hold: nothing of NaN, FILM_LIMIT of what is beyond it. Both are
/// counted.
static float film_cut(const Film* film, float value) {
    film_count_atomics(film, 1);  // hardly ever: not worth a register everywhere
    if (isnan(value)) {
        atom_inc(&film->counters->not_a_number);
        return 0.0f;
    }
    atom_inc(&film->counters->saturated);
    return copysign(FILM_LIMIT, value);
}

/// Values of four pixels in units of the film, to the nearest, ties to even. NaN is left out and counted; what is
/// beyond FILM_LIMIT is cut and counted.
static inline long16 film_units(const Film* film, float16 value) {
    if (any16(~(fabs(value) <= FILM_LIMIT))) {
        float* values = (float*)&value;
        for (uint i = 0; i < 16; ++i)
            if (!(fabs(values[i]) <= FILM_LIMIT)) values[i] = film_cut(film, values[i]);
    }
    value *= 4294967296.0f;
    // Floats from 2^23 on are whole. To smaller ones 2^23 is added, which leaves no bits behind the point: rint(),
    // without the dozen instructions that it may take.
    const float16 whole = select((float16)(0.0f), copysign((float16)(8388608.0f), value), fabs(value) < 8388608.0f);
    return convert_long16((value + whole) - whole);
}

static inline uint film_add_units(const Film* film, global long* sum, long units) {
    if (units == 0) return 0;
    const bool plain = (film->flags & FILM_PIXELS_ONCE) != 0;
    long before;
    if (plain) {
        before = *sum;
        *sum = (long)((ulong)before + (ulong)units);
    } else {
        before = atom_add(sum, units);
    }
    const long after = (long)((ulong)before + (ulong)units);
    if (((before ^ after) & (units ^ after)) < 0) film_count_atomics(film, film_count(&film->counters->saturated, 1));
    return plain ? 0 : 1;
}

/// Adds to all four channels of a pixel that nothing else that runs adds to; the channels that overflow, -1 each.
static inline long4 film_add_alone(global long* sum, long4 units) {
    const ulong4 before = *(global const ulong4*)sum, after = before + as_ulong4(units);
    *(global ulong4*)sum = after;
    return as_long4((before ^ after) & (as_ulong4(units) ^ after)) < 0;
}

static inline void film_count_overflow(const Film* film, long4 overflow) {
    const long overflows = -(overflow.x + overflow.y + overflow.z + overflow.w);
    if (overflows != 0) film_count_atomics(film, film_count(&film->counters->saturated, (uint)overflows));
}

/// Adds to all four channels of a pixel.
static inline uint film_add_units4(const Film* film, global long* sum, long4 units) {
    uint atomics = film_add_units(film, sum + 0, units.x);
    atomics += film_add_units(film, sum + 1, units.y);
    atomics += film_add_units(film, sum + 2, units.z);
    return atomics + film_add_units(film, sum + 3, units.w);
}

/// Radiance of two terms for each of up to LANES items: rows of three channels, and a fourth that is not read.
typedef struct {
    uint lanes;    // with an item, one bit each
    uint covered;  // of these, the hits of camera rays, which the beauty counts in its fourth channel
    uint pixel[LANES], route[LANES];
    Rows first, second;
} Terms;

/// Rows in units of the film: at most 2^57 for two terms of FILM_LIMIT each, so that sixteen add up to 2^61.
typedef union {
    long16 part[4];
    long4 row[LANES];
} UnitRows;

/// Adds the rows of `lanes` to their pixels in a plane; nothing where it is not kept. Neighbours of one pixel, as a
/// camera's samples are, are added up before.
COMPILED_ONCE static uint film_add_rows(const Film* film, uint plane, const uint* pixels, const UnitRows* rows,
                                        uint lanes) {
    if (lanes == 0 || (plane != FILM_BEAUTY && !film_keeps(film, plane))) return 0;
    global long* sums = film_pixel(film, plane, 0);
    if (film->flags & FILM_PIXELS_ONCE) {
        long4 overflow = (long4)(0);
        for (; lanes != 0; lanes &= lanes - 1) {
            const uint i = lowest_bit(lanes);
            overflow += film_add_alone(sums + (ulong)pixels[i] * FILM_CHANNELS, rows->row[i]);
        }
        film_count_overflow(film, overflow);
        return 0;
    }
    uint atomics = 0, pixel = pixels[lowest_bit(lanes)];
    long4 sum = (long4)(0);
    for (; lanes != 0; lanes &= lanes - 1) {
        const uint i = lowest_bit(lanes);
        if (pixels[i] != pixel) {
            atomics += film_add_units4(film, sums + (ulong)pixel * FILM_CHANNELS, sum);
            pixel = pixels[i];
            sum = (long4)(0);
        }
        sum += rows->row[i];
    }
    return atomics + film_add_units4(film, sums + (ulong)pixel * FILM_CHANNELS, sum);
}

/// Channels [first, last) of those rows of a part, four rows long, of which `lanes` has a bit.
static inline int16 channels_of(uint lanes, uint part, uint first, uint last) {
    const uint16 row = (uint16)(1, 1, 1, 1, 2, 2, 2, 2, 4, 4, 4, 4, 8, 8, 8, 8);
    const uint16 channel = (uint16)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
    return (((uint16)(lanes >> 4 * part) & row) != 0u) & (channel >= first) & (channel < last);
}

/// Rows' first channels, three or four of them, in units of the film; nothing for rows without an item, of which
/// `lanes` has no bit.
static inline UnitRows film_units_of_rows(const Film* film, const Rows* rows, uint channels, uint lanes) {
    UnitRows units;
    for (uint i = 0; i < 4; ++i)
        units.part[i] = film_units(film, select((float16)(0.0f), rows->part[i], channels_of(lanes, i, 0, channels)));
    return units;
}

/// Counts lanes in the fourth channel.
static inline void film_cover(UnitRows* rows, uint lanes) {
    for (uint i = 0; i < 4; ++i) rows->part[i] += convert_long16(channels_of(lanes, i, 3, 4)) & FILM_ONE;
}

/// Adds rows of four channels.
COMPILED_ONCE static uint film_add_values(const Film* film, uint plane, const uint* pixels, const Rows* rows,
                                          uint lanes) {
    const UnitRows units = film_units_of_rows(film, rows, 4, lanes);
    return film_add_rows(film, plane, pixels, &units, lanes);
}

/// Those of sixteen rays that go this way, one bit each.
static inline uint lanes_of_route(const uint* routes, uint route) {
    return lane_mask16(vload16(0, routes) == route);
}

/// Adds the radiance of two terms. The beauty gets the sum of their integers, so that the planes still add up to it,
/// and the coverage.
/// What camera hits send goes to the terms' own planes, the rest to that of the branch which the path took first.
COMPILED_ONCE static uint film_add_terms(const Film* film, uint first_term, uint second_term, const Terms* terms) {
    const UnitRows first = film_units_of_rows(film, &terms->first, 3, terms->lanes);
    const UnitRows second = film_units_of_rows(film, &terms->second, 3, terms->lanes);
    UnitRows both;
    for (uint i = 0; i < 4; ++i) both.part[i] = first.part[i] + second.part[i];
    if (terms->covered != 0) film_cover(&both, terms->covered);
    uint atomics = film_add_rows(film, FILM_BEAUTY, terms->pixel, &both, terms->lanes);
    if (!(film_keeps(film, first_term) || film_keeps(film, second_term) || film_keeps(film, FILM_REFLECTION) ||
          film_keeps(film, FILM_REFRACTION)))
        return atomics;
    const uint camera = lanes_of_route(terms->route, ROUTE_CAMERA) & terms->lanes;
    const uint reflected = lanes_of_route(terms->route, ROUTE_REFLECTED) & terms->lanes;
    atomics += film_add_rows(film, first_term, terms->pixel, &first, camera);
    atomics += film_add_rows(film, second_term, terms->pixel, &second, camera);
    atomics += film_add_rows(film, FILM_REFLECTION, terms->pixel, &both, reflected);
    return atomics + film_add_rows(film, FILM_REFRACTION, terms->pixel, &both, terms->lanes & ~camera & ~reflected);
}

#endif
