// What a hit is, rather than what light it sends: albedo, normal, position, ids, depth.
// Reads:  rays [first_ray, first_ray + count), hits [0, count).
// Writes: film, the planes of features that are kept.
// Next:   nothing; it runs beside shade, where such planes are asked for.

#include "lib/film.h"
#include "lib/shading.h"

/// Colour that the surface gives to white light from everywhere: what denoisers call albedo.
static inline float3 albedo(const Shading* s) {
    const float passed_on = s->material->reflection + s->material->transmission;
    return s->diffuse * s->local_share + load3(s->material->base_color) * passed_on;
}

/// Returns how many adds were not of zero.
static inline uint add_camera_hit(const Film* film, const World* world, constant CameraRecord* camera, uint object,
                                  const Shading* s) {
    const uint pixel = s->ray->pixel;
    uint adds = 0;
    if (film_keeps(film, FILM_ALBEDO)) adds += film_add(film, FILM_ALBEDO, pixel, albedo(s));
    if (film_keeps(film, FILM_NORMAL)) adds += film_add(film, FILM_NORMAL, pixel, s->surface.shading_normal);
    if (film_keeps(film, FILM_POSITION)) {
        const float3 p = s->surface.position;
        const float z = dot3(p - constant3(camera->eye), constant3(camera->forward));
        adds += film_add(film, FILM_POSITION, pixel, p);
        adds += film_add_units(film, film_pixel(film, FILM_POSITION, pixel) + 3, film_units(film, z));
    }
    if (film_keeps(film, FILM_IDS) && s->ray->sample == 0) {
        global long* ids = film_pixel(film, FILM_IDS, pixel);
        ids[0] = (long)object + 1;
        ids[1] = (long)s->surface.material + 1;
    }
    return adds;
}

/// One work-item a chunk of CHUNK rays, all of depth `depth`.
kernel void features(global const Ray* rays, uint first_ray, uint count, uint depth, global const Hit* hits,
                     global const Vertex* vertices, global const Triangle* triangles, global const Sphere* spheres,
                     global const Plane* planes, global const Material* materials, global const Texture* textures,
                     global const float* texels, constant CameraRecord* camera, constant SceneConstants* constants,
                     global long* film_sums, global Counters* counters, uint film_flags) {
    const World world = {vertices, triangles, spheres, planes, materials, textures, texels, constants};
    const Film film = {film_sums, counters, constants, film_flags, ATOMICS_FEATURES};
    const uint begin = get_global_id(0) * CHUNK;
    const uint end = min(begin + CHUNK, count);
    uint adds = 0, others = 0;
    for (uint i = begin; i < end; ++i) {
        global const Ray* ray = rays + first_ray + i;
        if (film_keeps(&film, FILM_IDS)) {
            global long* ids = film_pixel(&film, FILM_IDS, ray->pixel);
            atom_max(ids + 2, (long)depth);
            ++others;
            if (ray->route == ROUTE_CAMERA) {
                atom_inc(ids + 3);
                ++others;
            }
        }
        if (ray->route != ROUTE_CAMERA || hits[i].primitive == NO_INDEX) continue;
        const Shading shading = shading_at(&world, ray, hits[i]);
        adds += add_camera_hit(&film, &world, camera, object_of(&world, hits[i].primitive), &shading);
    }
    film_count_atomics(&film, adds, others);
}
