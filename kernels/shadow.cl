// Visibility of the light samples; what is not blocked adds its term.
// Reads:  shadow_rays and shadow_counts, segments of CHUNK.
// Writes: film.
// Next:   the next range of light samples, or secondary.

#include "lib/film.h"
#include "lib/surface.h"

/// What is left of light from t_max away: filtered by every transmissive surface on the way, each crossing once.
static inline float3 transmittance(const Geometry* geometry, const World* world, global const ShadowRay* ray) {
    constant SceneConstants* constants = world->constants;
    const float3 origin = load3(ray->origin), direction = load3(ray->direction);
    if (constants->shadows == SHADOWS_NONE) return (float3)(1.0f);
    if (constants->shadows == SHADOWS_OPAQUE || !constants->any_filter)
        return is_blocked(geometry, origin, direction, ray->t_max) ? (float3)(0.0f) : (float3)(1.0f);
    // In the order of distance, so that the product's bits do not depend on the hierarchy.
    float3 left = (float3)(1.0f);
    Hit hit = {0.0f, 0.0f, 0.0f, NO_INDEX};
    for (;;) {
        hit = closest_hit_after(geometry, origin, direction, hit, ray->t_max);
        if (hit.primitive == NO_INDEX) return left;
        global const Material* filter = world->materials + material_of(world, hit.primitive);
        left *= load3(filter->base_color) * filter->transmission;
        if (!any(left != 0.0f)) return left;
    }
}

/// One work-item a segment.
kernel void shadow(global const ShadowRay* shadow_rays, global const uint* shadow_counts, uint segment_count,
                   global const BvhNode* nodes, global const TriangleBlock* triangle_blocks,
                   global const SphereBlock* sphere_blocks, global const Plane* planes,
                   global const Triangle* triangles, global const Sphere* spheres, global const Material* materials,
                   constant SceneConstants* constants, global long* film_sums, global Counters* counters) {
    const Film film = {film_sums, counters, constants};
    const Geometry geometry = scene_geometry(nodes, triangle_blocks, sphere_blocks, planes, constants);
    const World world = {0, triangles, spheres, planes, materials, 0, 0, constants};
    const uint segment = get_global_id(0);
    if (segment >= segment_count) return;
    const uint count = shadow_counts[segment];
    uint blocked = 0;
    for (uint i = 0; i < count; ++i) {
        global const ShadowRay* ray = shadow_rays + segment * CHUNK + i;
        const float3 left = transmittance(&geometry, &world, ray);
        if (ray->route == ROUTE_CAMERA && film_keeps(&film, FILM_SHADOW)) {
            film_add(&film, FILM_SHADOW, ray->pixel, left);
            film_add_units(&film, film_pixel(&film, FILM_SHADOW, ray->pixel) + 3, FILM_ONE);
        }
        if (any(left != 0.0f)) {
            film_add_radiance(&film, FILM_DIFFUSE, ray->route, ray->pixel, left * load3(ray->diffuse));
            film_add_radiance(&film, FILM_SPECULAR, ray->route, ray->pixel, left * load3(ray->specular));
        } else {
            ++blocked;
        }
    }
    if (blocked != 0) atom_add(&counters->shadow_blocked, (ulong)blocked);
}
