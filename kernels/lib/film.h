// The film: 64-bit sums in units of 2^-32, FILM_CHANNELS a pixel and plane. Integer addition has no order, so neither
// the size of a queue nor the number of threads can change a bit of the picture.
#ifndef RAYMILL_FILM_H
#define RAYMILL_FILM_H

#include "lib/math.h"

typedef struct {
    global long* sums;
    global Counters* counters;
    constant SceneConstants* constants;
    uint flags;         // FILM_PIXELS_ONCE ...
    uint kernel_place;  // in Counters::atomics
} Film;

// What adds to the film returns how many adds were not of zero; the kernel hands their number to film_count_atomics().

/// Adds to one of the counters that every frame needs, unless there is nothing to add. Returns how many atomic
/// operations that took.
static inline uint film_count(global ulong* counter, uint number) {
    if (number == 0) return 0;
    atom_add(counter, (ulong)number);
    return 1;
}

/// Adds to one of those that only the profile needs.
static inline void film_profile(const Film* film, global ulong* counter, uint number) {
    if ((film->flags & FILM_COUNTED) && number != 0) atom_add(counter, (ulong)number);
}

/// film_adds: adds to the film that were not of zero. others: operations that are atomic in any case.
static inline void film_count_atomics(const Film* film, uint film_adds, uint others) {
    film_profile(film, film->counters->atomics + film->kernel_place,
                 (film->flags & FILM_PIXELS_ONCE ? 0 : film_adds) + others);
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
    film_count_atomics(film, 0, 1);  // hardly ever: not worth a register everywhere
    if (isnan(value)) {
        atom_inc(&film->counters->not_a_number);
        return 0.0f;
    }
    atom_inc(&film->counters->saturated);
    return copysign(FILM_LIMIT, value);
}

/// A value in units of the film, to the nearest, ties to even. NaN is left out and counted; what is beyond FILM_LIMIT
/// is cut and counted.
static inline long film_units(const Film* film, float value) {
    if (!(fabs(value) <= FILM_LIMIT)) value = film_cut(film, value);
    value *= 4294967296.0f;
    // Floats from 2^23 on are whole. To smaller ones 2^23 is added, which leaves no bits behind the point: rint(),
    // without the dozen instructions that it may take.
    const float whole = fabs(value) < 8388608.0f ? copysign(8388608.0f, value) : 0.0f;
    return (long)((value + whole) - whole);
}

static inline long3 film_units3(const Film* film, float3 value) {
    return (long3)(film_units(film, value.x), film_units(film, value.y), film_units(film, value.z));
}

static inline uint film_add_units(const Film* film, global long* sum, long units) {
    if (units == 0) return 0;
    long before;
    if (film->flags & FILM_PIXELS_ONCE) {
        before = *sum;
        *sum = (long)((ulong)before + (ulong)units);
    } else {
        before = atom_add(sum, units);
    }
    const long after = (long)((ulong)before + (ulong)units);
    if (((before ^ after) & (units ^ after)) < 0)
        film_count_atomics(film, 0, film_count(&film->counters->saturated, 1));
    return 1;
}

/// Adds to the first three channels of one plane.
static inline uint film_add_units3(const Film* film, uint plane, uint pixel, long3 units) {
    global long* sum = film_pixel(film, plane, pixel);
    film_add_units(film, sum + 0, units.x);
    film_add_units(film, sum + 1, units.y);
    film_add_units(film, sum + 2, units.z);
    return (units.x != 0) + (units.y != 0) + (units.z != 0);
}

static inline uint film_add(const Film* film, uint plane, uint pixel, float3 value) {
    return film_add_units3(film, plane, pixel, film_units3(film, value));
}

/// The plane that light of this kind belongs to: `term` for camera hits, else that of the branch which the path took
/// first.
static inline uint film_plane(uint term, uint route) {
    return route == ROUTE_CAMERA ? term : route == ROUTE_REFLECTED ? FILM_REFLECTION : FILM_REFRACTION;
}

/// Adds radiance to the beauty, and to the plane it belongs to if that is kept.
static inline uint film_add_radiance(const Film* film, uint term, uint route, uint pixel, float3 radiance) {
    const long3 units = film_units3(film, radiance);
    const uint adds = film_add_units3(film, FILM_BEAUTY, pixel, units);
    const uint plane = film_plane(term, route);
    return film_keeps(film, plane) ? adds + film_add_units3(film, plane, pixel, units) : adds;
}

/// Adds the radiance of two terms. The beauty gets the sum of their integers, so that the planes still add up to it.
static inline uint film_add_two(const Film* film, uint route, uint pixel, uint first_term, float3 first,
                                uint second_term, float3 second) {
    const long3 a = film_units3(film, first), b = film_units3(film, second);
    uint adds = film_add_units3(film, FILM_BEAUTY, pixel, a + b);
    const uint plane_a = film_plane(first_term, route), plane_b = film_plane(second_term, route);
    if (film_keeps(film, plane_a)) adds += film_add_units3(film, plane_a, pixel, a);
    if (film_keeps(film, plane_b)) adds += film_add_units3(film, plane_b, pixel, b);
    return adds;
}

#endif
