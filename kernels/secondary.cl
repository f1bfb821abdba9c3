// Reflected and refracted rays of a batch's hits.
// Reads:  rays [first_ray, first_ray + count), hits [0, count).
// Writes: children, from 0 on; counters->children, and parents where the frame is profiled.
// Next:   intersect, one level deeper.

#include "lib/material.h"
#include "lib/random.h"

/// Weight of a child, colours included; zero where it is cut.
static inline float3 child_throughput(const World* world, global const Material* material, float3 throughput,
                                      float share) {
    const float3 weight = throughput * load3(material->base_color) * share;
    return max3(weight) >= world->constants->min_weight ? weight : (float3)(0.0f);
}

/// The children of one hit, at most two.
typedef struct {
    Surface surface;
    Split split;
    float3 reflected, refracted;  // throughputs; zero means no ray
} Children;

static inline uint children_of(const World* world, global const Ray* ray, Hit hit, Children* c) {
    const float3 direction = load3(ray->direction);
    c->surface = surface_at(world, load3(ray->origin), direction, hit);
    global const Material* material = world->materials + c->surface.material;
    c->split = split_ray(material, &c->surface, direction);
    const float3 throughput = absorbed(material, &c->surface, load3(ray->throughput), hit.t);
    c->reflected = child_throughput(world, material, throughput, c->split.reflection);
    c->refracted = child_throughput(world, material, throughput, c->split.transmission);
    return (any(c->reflected != 0.0f) ? 1u : 0u) + (any(c->refracted != 0.0f) ? 1u : 0u);
}

static inline void write_child(const World* world, global const Ray* parent, const Surface* surface, float side,
                               float3 direction, float3 throughput, uint branch, global Ray* child) {
    store3(child->origin, leave_surface(world, surface, side));
    store3(child->direction, direction);
    store3(child->throughput, throughput);
    child->pixel = parent->pixel;
    child->sample = parent->sample;
    child->path = path_child(parent->path, branch);
    child->route = parent->route != ROUTE_CAMERA ? parent->route : branch == 0 ? ROUTE_REFLECTED : ROUTE_REFRACTED;
}

/// One work-item a chunk of CHUNK hits: counts its children, takes their places with one atomic add, writes them.
kernel void secondary(global const Ray* rays, uint first_ray, uint count, global const Hit* hits,
                      global const Vertex* vertices, global const Triangle* triangles, global const Sphere* spheres,
                      global const Plane* planes, global const Material* materials, global const Texture* textures,
                      global const float* texels, constant SceneConstants* constants, global Ray* children,
                      uint capacity, global Counters* counters, uint counted) {
    const World world = {vertices, triangles, spheres, planes, materials, textures, texels, constants};
    const uint begin = get_global_id(0) * CHUNK;
    const uint end = min(begin + CHUNK, count);
    Children c;
    uint spawned = 0, parents = 0;
    for (uint i = begin; i < end; ++i) {
        if (!may_spawn(&world, hits[i].primitive)) continue;
        const uint found = children_of(&world, rays + first_ray + i, hits[i], &c);
        spawned += found;
        parents += found != 0;
    }
    if (spawned == 0) return;

    if (counted) {
        atom_add(&counters->parents, (ulong)parents);
        atom_inc(&counters->atomics[ATOMICS_SECONDARY]);  // the one below
    }
    ulong place = atom_add(&counters->children, (ulong)spawned);
    if (place + spawned > capacity) return;  // the host sees the count and stops
    for (uint i = begin; i < end; ++i) {
        global const Ray* ray = rays + first_ray + i;
        if (!may_spawn(&world, hits[i].primitive) || children_of(&world, ray, hits[i], &c) == 0) continue;
        if (any(c.reflected != 0.0f))
            write_child(&world, ray, &c.surface, 1.0f, c.split.reflected, c.reflected, 0, children + place++);
        if (any(c.refracted != 0.0f))
            write_child(&world, ray, &c.surface, -1.0f, c.split.refracted, c.refracted, 1, children + place++);
    }
}
