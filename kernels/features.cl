// What a hit is, rather than what light it sends: albedo, normal, position, ids, depth.
// Reads:  rays [first_ray, first_ray + count), hits [0, count).
// Writes: film, the planes of features that are kept.
// Next:   nothing; it runs beside shade, where such planes are asked for.

#include "lib/film.h"
#include "lib/shading.h"

/// Colour that the surfaces give to white light from everywhere: what denoisers call albedo.
static inline Lanes3 albedo(const World* world, const Shading* s) {
    global const Material* first = world->materials;
    const float16 reflection = material4(world, &s->surface, first->diffuse).w;
    const float16 transmission = material4(world, &s->surface, first->specular).w;
    const Lanes3 base_color = lanes_xyz(material4(world, &s->surface, first->base_color));
    return lanes_add(lanes_scale(s->diffuse, s->local_share), lanes_scale(base_color, reflection + transmission));
}

/// Adds one of these to each camera hit.
static inline uint add_feature(const Film* film, uint plane, const Shading* s, Lanes3 value, float16 fourth) {
    const Rows rows = rows_of(value, fourth);
    return film_add_values(film, plane, (const uint*)&s->hits.pixel, &rows, first_lanes(s->hits.count));
}

/// Objects and materials are those of sample 0.
static inline void set_ids(const Film* film, const World* world, const Shading* s) {
    for (uint lane = 0; lane < s->hits.count; ++lane) {
        if (((const uint*)&s->hits.sample)[lane] != 0) continue;
        global long* ids = film_pixel(film, FILM_IDS, ((const uint*)&s->hits.pixel)[lane]);
        ids[0] = (long)object_of(world, ((const uint*)&s->hits.primitive)[lane]) + 1;
        ids[1] = (long)((const uint*)&s->surface.material)[lane] + 1;
    }
}

static inline uint add_camera_hits(const Film* film, const World* world, constant CameraRecord* camera,
                                   const Shading* s) {
    const float16 nothing = (float16)(0.0f);
    uint atomics = 0;
    if (film_keeps(film, FILM_ALBEDO)) atomics += add_feature(film, FILM_ALBEDO, s, albedo(world, s), nothing);
    if (film_keeps(film, FILM_NORMAL)) atomics += add_feature(film, FILM_NORMAL, s, s->surface.shading_normal, nothing);
    if (film_keeps(film, FILM_POSITION)) {
        const Lanes3 p = s->surface.position;
        const Lanes3 from_eye = lanes_sub(p, lanes_of(constant3(camera->eye)));
        atomics += add_feature(film, FILM_POSITION, s, p, lanes_dot(from_eye, lanes_of(constant3(camera->forward))));
    }
    if (film_keeps(film, FILM_IDS)) set_ids(film, world, s);
    return atomics;
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
    uint places[CHUNK], found = 0, atomics = 0;
    for (uint i = begin; i < end; ++i) {
        global const Ray* ray = rays + first_ray + i;
        if (film_keeps(&film, FILM_IDS)) {
            global long* ids = film_pixel(&film, FILM_IDS, ray->pixel);
            atom_max(ids + 2, (long)depth);
            ++atomics;
            if (ray->route == ROUTE_CAMERA) {
                atom_inc(ids + 3);
                ++atomics;
            }
        }
        if (ray->route == ROUTE_CAMERA && hits[i].primitive != NO_INDEX) places[found++] = i;
    }
    for (uint first = 0; first < found; first += LANES) {
        Shading shading;
        shading.hits = gather_hits(rays + first_ray, hits, places + first, min((uint)LANES, found - first));
        shade_hits(&world, &shading);
        atomics += add_camera_hits(&film, &world, camera, &shading);
    }
    film_count_atomics(&film, atomics);
}
