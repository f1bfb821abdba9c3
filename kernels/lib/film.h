// The film: 64-bit sums in units of 2^-32, FILM_CHANNELS a pixel and plane. Integer addition has no order, so neither the
// size of a queue nor the number of threads can change a bit of the picture.
#ifndef RAYMILL_FILM_H
#define RAYMILL_FILM_H

#include "lib/math.h"

typedef struct {
    global long* sums;
    global Counters* counters;
    constant SceneConstants* constants;
} Film;

/// The pixel's channels of a plane that is kept.
static inline global long* film_pixel(const Film* film, uint plane, uint pixel) {
    return film->sums + ((ulong)film->constants->plane[plane] * film->constants->film_pixels + pixel) * FILM_CHANNELS;
}

static inline bool film_keeps(const Film* film, uint plane) { return film->constants->plane[plane] != 0; }

/// A value in units of the film. NaN is left out and counted; what is beyond FILM_LIMIT is cut and counted.
static inline long film_units(const Film* film, float value) {
    if (isnan(value)) {
        atom_inc(&film->counters->not_a_number);
        return 0;
    }
    if (fabs(value) > FILM_LIMIT) {
        atom_inc(&film->counters->saturated);
        value = copysign(FILM_LIMIT, value);
    }
    return (long)rint(value * 4294967296.0f);
}

static inline void film_add_units(const Film* film, global long* sum, long units) {
    if (units == 0) return;
    const long before = atom_add(sum, units);
    const long after = (long)((ulong)before + (ulong)units);
    if (((before ^ after) & (units ^ after)) < 0) atom_inc(&film->counters->saturated);
}

/// Adds to the first three channels of one plane.
static inline void film_add(const Film* film, uint plane, uint pixel, float3 value) {
    global long* sum = film_pixel(film, plane, pixel);
    film_add_units(film, sum + 0, film_units(film, value.x));
    film_add_units(film, sum + 1, film_units(film, value.y));
    film_add_units(film, sum + 2, film_units(film, value.z));
}

/// Adds radiance to the beauty, and to the plane it belongs to if that is kept: `term` for camera hits, else the plane of
/// the branch that the path took first.
static inline void film_add_radiance(const Film* film, uint term, uint route, uint pixel, float3 radiance) {
    const long r = film_units(film, radiance.x), g = film_units(film, radiance.y), b = film_units(film, radiance.z);
    global long* beauty = film_pixel(film, FILM_BEAUTY, pixel);
    film_add_units(film, beauty + 0, r);
    film_add_units(film, beauty + 1, g);
    film_add_units(film, beauty + 2, b);
    const uint plane = route == ROUTE_CAMERA ? term : route == ROUTE_REFLECTED ? FILM_REFLECTION : FILM_REFRACTION;
    if (!film_keeps(film, plane)) return;
    global long* part = film_pixel(film, plane, pixel);
    film_add_units(film, part + 0, r);
    film_add_units(film, part + 1, g);
    film_add_units(film, part + 2, b);
}

#endif
