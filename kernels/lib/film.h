// The film: 64-bit sums in units of 2^-32, FILM_CHANNELS a pixel and plane. Integer addition has no order, so neither
// the size of a queue nor the number of threads can change a bit of the picture.
#ifndef RAYMILL_FILM_H
#define RAYMILL_FILM_H

#include "lib/gather.h"

typedef struct {
    global long* sums;
    global Counters* counters;
    constant SceneConstants* constants;
    bool pixels_once;  // no two items of the launch have the same pixel, so that plain adds do
} Film;

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
    if (isnan(value)) {
        atom_inc(&film->counters->not_a_number);
        return 0.0f;
    }
    atom_inc(&film->counters->saturated);
    return copysign(FILM_LIMIT, value);
}

/// Values in units of the film, to the nearest, ties to even. NaN is left out and counted; what is beyond FILM_LIMIT
/// is cut and counted.
static inline long8 film_units8(const Film* film, float8 value) {
    if (lane_mask(fabs(value) <= FILM_LIMIT) != 0xff) {
        float* values = (float*)&value;
        for (uint i = 0; i < 8; ++i)
            if (!(fabs(values[i]) <= FILM_LIMIT)) values[i] = film_cut(film, values[i]);
    }
    value *= 4294967296.0f;
    // Floats from 2^23 on are whole. To smaller ones 2^23 is added, which leaves no bits behind the point: rint(),
    // without the dozen instructions that it may take.
    const float8 whole = select((float8)(0.0f), copysign((float8)(8388608.0f), value), fabs(value) < 8388608.0f);
    return convert_long8((value + whole) - whole);
}

static inline void film_add_units(const Film* film, global long* sum, long units) {
    if (units == 0) return;
    long before;
    if (film->pixels_once) {
        before = *sum;
        *sum = (long)((ulong)before + (ulong)units);
    } else {
        before = atom_add(sum, units);
    }
    const long after = (long)((ulong)before + (ulong)units);
    if (((before ^ after) & (units ^ after)) < 0) atom_inc(&film->counters->saturated);
}

/// Counts the lanes whose sign says that a sum overflowed.
static void film_count_overflows(const Film* film, long4 overflow) {
    const long4 count = overflow >> 63;
    atom_sub(&film->counters->saturated, (ulong)(count.x + count.y + count.z + count.w));
}

/// Adds to all four channels of a pixel.
static inline void film_add_units4(const Film* film, global long* sum, long4 units) {
    if (film->pixels_once) {
        const long4 before = *(global const long4*)sum;
        const ulong4 wrapped = as_ulong4(before) + as_ulong4(units);
        const long4 after = as_long4(wrapped);
        *(global long4*)sum = after;
        const long4 overflow = (before ^ after) & (units ^ after);
        const long2 either = overflow.lo | overflow.hi;
        if ((either.x | either.y) < 0) film_count_overflows(film, overflow);
    } else {
        film_add_units(film, sum + 0, units.x);
        film_add_units(film, sum + 1, units.y);
        film_add_units(film, sum + 2, units.z);
        film_add_units(film, sum + 3, units.w);
    }
}

static inline void film_add(const Film* film, uint plane, uint pixel, float4 value) {
    film_add_units4(film, film_pixel(film, plane, pixel), film_units8(film, (float8)(value, (float4)(0.0f))).lo);
}

/// The plane that light of this kind belongs to: `term` for camera hits, else that of the branch which the path took
/// first.
static inline uint film_plane(uint term, uint route) {
    return route == ROUTE_CAMERA ? term : route == ROUTE_REFLECTED ? FILM_REFLECTION : FILM_REFRACTION;
}

/// Adds radiance to the beauty, and to the plane it belongs to if that is kept.
static inline void film_add_radiance(const Film* film, uint term, uint route, uint pixel, float3 radiance) {
    const long4 units = film_units8(film, (float8)(radiance, 0.0f, (float4)(0.0f))).lo;
    film_add_units4(film, film_pixel(film, FILM_BEAUTY, pixel), units);
    const uint plane = film_plane(term, route);
    if (film_keeps(film, plane)) film_add_units4(film, film_pixel(film, plane, pixel), units);
}

/// Adds the radiance of two terms, three channels each. The beauty gets the sum of their integers, so that the planes
/// still add up to it.
static inline void film_add_two(const Film* film, uint route, uint pixel, uint first_term, float4 first,
                                uint second_term, float4 second) {
    const long8 units = film_units8(film, (float8)(first, second));
    const long4 a = units.lo, b = units.hi;
    film_add_units4(film, film_pixel(film, FILM_BEAUTY, pixel), a + b);
    const uint plane_a = film_plane(first_term, route), plane_b = film_plane(second_term, route);
    if (film_keeps(film, plane_a)) film_add_units4(film, film_pixel(film, plane_a, pixel), a);
    if (film_keeps(film, plane_b)) film_add_units4(film, film_pixel(film, plane_b, pixel), b);
}

/// film_add_two() for up to sixteen items: rows of three channels each, and one that must be 0.
static inline void film_add_rows(const Film* film, uint count, const uint* route, const uint* pixel, uint first_term,
                                 const Rows* first, uint second_term, const Rows* second) {
    for (uint lane = 0; lane < count; ++lane)
        film_add_two(film, route[lane], pixel[lane], first_term, row_of(first, lane), second_term,
                     row_of(second, lane));
}

#endif
