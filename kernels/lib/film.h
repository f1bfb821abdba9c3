// The film: 64-bit sums in units of 2^-32, FILM_CHANNELS a pixel and plane. Integer addition has no order, so neither the
// size of a queue nor the number of threads can change a bit of the picture.
#ifndef RAYMILL_FILM_H
#define RAYMILL_FILM_H

#include "lib/math.h"

typedef struct {
    global long* sums;
    global Counters* counters;
    constant SceneConstants* constants;
    uint flags;    // FILM_PIXELS_ONCE ...
    uint atomics;  // operations that this work-item has issued
} Film;

static inline Film film_of(global long* sums, global Counters* counters, constant SceneConstants* constants,
                           uint flags) {
    const Film film = {sums, counters, constants, flags, 0};
    return film;
}

/// Adds to one of the counters that every frame needs; none where there is nothing to add.
static inline void film_count(Film* film, global ulong* counter, uint number) {
    if (number == 0) return;
    atom_add(counter, (ulong)number);
    ++film->atomics;
}

/// Adds to one of those that only the profile needs.
static inline void film_profile(const Film* film, global ulong* counter, uint number) {
    if ((film->flags & FILM_COUNTED) && number != 0) atom_add(counter, (ulong)number);
}

/// The kernel's last call, with its place in Counters::atomics.
static inline void film_count_atomics(const Film* film, uint kernel_place) {
    film_profile(film, film->counters->atomics + kernel_place, film->atomics);
}

/// The pixel's channels of a plane that is kept.
static inline global long* film_pixel(const Film* film, uint plane, uint pixel) {
    return film->sums + ((ulong)film->constants->plane[plane] * film->constants->film_pixels + pixel) * FILM_CHANNELS;
}

static inline bool film_keeps(const Film* film, uint plane) { return film->constants->plane[plane] != 0; }

/// What is stored of a value that the film does not hold: nothing of NaN, FILM_LIMIT of what is beyond it. Both are
/// counted.
static float film_cut(global Counters* counters, float value) {
    if (isnan(value)) {
        atom_inc(&counters->not_a_number);
        return 0.0f;
    }
    atom_inc(&counters->saturated);
    return copysign(FILM_LIMIT, value);
}

/// A value in units of the film, to the nearest, ties to even. NaN is left out and counted; what is beyond FILM_LIMIT
/// is cut and counted.
static inline long film_units(Film* film, float value) {
    if (!(fabs(value) <= FILM_LIMIT)) {
        value = film_cut(film->counters, value);
        ++film->atomics;
    }
    value *= 4294967296.0f;
    // Floats from 2^23 on are whole. To smaller ones 2^23 is added, which leaves no bits behind the point: rint(),
    // without the dozen instructions that it may take.
    const float whole = fabs(value) < 8388608.0f ? copysign(8388608.0f, value) : 0.0f;
    return (long)((value + whole) - whole);
}

static inline long3 film_units3(Film* film, float3 value) {
    return (long3)(film_units(film, value.x), film_units(film, value.y), film_units(film, value.z));
}

static inline void film_add_units(Film* film, global long* sum, long units) {
    if (units == 0) return;
    long before;
    if (film->flags & FILM_PIXELS_ONCE) {
        before = *sum;
        *sum = (long)((ulong)before + (ulong)units);
    } else {
        before = atom_add(sum, units);
        ++film->atomics;
    }
    const long after = (long)((ulong)before + (ulong)units);
    if (((before ^ after) & (units ^ after)) < 0) film_count(film, &film->counters->saturated, 1);
}

/// Adds to the first three channels of one plane.
static inline void film_add_units3(Film* film, uint plane, uint pixel, long3 units) {
    global long* sum = film_pixel(film, plane, pixel);
    film_add_units(film, sum + 0, units.x);
    film_add_units(film, sum + 1, units.y);
    film_add_units(film, sum + 2, units.z);
}

static inline void film_add(Film* film, uint plane, uint pixel, float3 value) {
    film_add_units3(film, plane, pixel, film_units3(film, value));
}

/// The plane that light of this kind belongs to: `term` for camera hits, else that of the branch which the path took
/// first.
static inline uint film_plane(uint term, uint route) {
    return route == ROUTE_CAMERA ? term : route == ROUTE_REFLECTED ? FILM_REFLECTION : FILM_REFRACTION;
}

/// Adds radiance to the beauty, and to the plane it belongs to if that is kept.
static inline void film_add_radiance(Film* film, uint term, uint route, uint pixel, float3 radiance) {
    const long3 units = film_units3(film, radiance);
    film_add_units3(film, FILM_BEAUTY, pixel, units);
    const uint plane = film_plane(term, route);
    if (film_keeps(film, plane)) film_add_units3(film, plane, pixel, units);
}

/// Adds the radiance of two terms. The beauty gets the sum of their integers, so that the planes still add up to it.
static inline void film_add_two(Film* film, uint route, uint pixel, uint first_term, float3 first,
                                uint second_term, float3 second) {
    const long3 a = film_units3(film, first), b = film_units3(film, second);
    film_add_units3(film, FILM_BEAUTY, pixel, a + b);
    const uint plane_a = film_plane(first_term, route), plane_b = film_plane(second_term, route);
    if (film_keeps(film, plane_a)) film_add_units3(film, plane_a, pixel, a);
    if (film_keeps(film, plane_b)) film_add_units3(film, plane_b, pixel, b);
}

#endif
