// What a light sample gives to sixteen points: direction, distance, and I_in of the lecture, without visibility.
#ifndef RAYMILL_LIGHT_H
#define RAYMILL_LIGHT_H

#include "lib/lanes.h"
#include "lib/sampling.h"

typedef struct {
    Lanes3 direction;  // unit, towards the light
    float16 distance;  // INFINITY for directional lights
    Lanes3 incoming;   // I_in, divided by the number of samples
} LightSample;

// A shadow ray ends this much of its length before the light, so that a lamp's own surface does not block it.
#define LIGHT_REACH (1.0f - 1e-4f)

static inline LightSample towards(Lanes3 position, Lanes3 p) {
    const Lanes3 to_light = lanes_sub(position, p);
    LightSample s;
    s.distance = lanes_length(to_light);
    s.direction = lanes_scale(to_light, 1.0f / s.distance);
    return s;
}

/// Point and spot lights at `position`, seen from p.
static inline LightSample from_position(global const LightRecord* light, Lanes3 position, Lanes3 p) {
    LightSample s = towards(position, p);
    const float16 c0 = (float16)(light->attenuation[0]), c1 = (float16)(light->attenuation[1]);
    const float16 c2 = (float16)(light->attenuation[2]);
    const float16 attenuation = 1.0f / fma(fma(c2, s.distance, c1), s.distance, c0);
    s.incoming = lanes_scale(lanes_of(load3(light->intensity)), attenuation / (float)light->samples);
    if (light->type == LIGHT_SPOT) {
        const float16 cosine = -lanes_dot(s.direction, lanes_of(load3(light->normal)));
        const float16 slope = fma(cosine, (float16)(light->cone_scale), (float16)(light->cone_offset));
        const float16 cone = select(positive16(slope), (float16)(1.0f), slope > 1.0f);
        s.incoming = lanes_scale(s.incoming, cone * cone);
    }
    return s;
}

/// A flat area light's sample point: I_in = L cos dA / (pi d^2).
static inline LightSample from_area(global const LightRecord* light, Lanes3 position, Lanes3 p) {
    LightSample s = towards(position, p);
    const float16 cosine = positive16(-lanes_dot(s.direction, lanes_of(load3(light->normal))));
    const float16 form = cosine * light->area / (PI * s.distance * s.distance * (float)light->samples);
    s.incoming = lanes_scale(lanes_of(load3(light->intensity)), form);
    return s;
}

/// A sphere light by its visible cap: I_in = L * solid angle / pi. Nothing from inside.
static inline LightSample from_sphere(global const LightRecord* light, Lanes3 p, float16 square_x, float16 square_y) {
    const Lanes3 to_center = lanes_sub(lanes_of(load3(light->position)), p);
    const float16 d2 = lanes_dot(to_center, to_center);
    const float r2 = light->radius * light->radius;
    const float16 sin2_max = r2 / d2;
    // 1 - cos without cancellation.
    const float16 cap = sin2_max / (1.0f + sqrt(positive16(1.0f - sin2_max)));
    const float16 below = square_x * cap;  // 1 - cos of the sample
    const float16 cosine = 1.0f - below;
    const float16 sin2 = below * (2.0f - below);
    float16 around_x, around_y;
    lanes_cos_sin(square_y, &around_x, &around_y);
    const float16 sine = sqrt(sin2), d = sqrt(d2);
    const Lanes3 axis = lanes_div(to_center, d);
    Lanes3 t, u;
    lanes_tangents(axis, &t, &u);
    const Lanes3 across = lanes_fma(around_y * sine, u, lanes_scale(axis, cosine));
    const int16 outside = d2 > r2;
    LightSample s;
    s.direction =
        lanes_select(lanes_of((float3)(0.0f, 1.0f, 0.0f)), lanes_unit(lanes_fma(around_x * sine, t, across)), outside);
    s.distance = select((float16)(0.0f), d * cosine - sqrt(positive16(r2 - d2 * sin2)), outside);
    const Lanes3 incoming = lanes_scale(lanes_of(load3(light->intensity)), 2.0f * cap / (float)light->samples);
    s.incoming = lanes_select(lanes_of((float3)(0.0f)), incoming, outside);
    return s;
}

/// The point of the light that the sample picks: of the ball of a point light, of a rectangle or a disk.
static inline Lanes3 light_point(global const LightRecord* light, float16 square_x, float16 square_y) {
    const Lanes3 position = lanes_of(load3(light->position));
    const Lanes3 axis_u = lanes_of(load3(light->axis_u)), axis_v = lanes_of(load3(light->axis_v));
    if (light->type == LIGHT_RECTANGLE)
        return lanes_fma(square_x - 0.5f, axis_u, lanes_fma(square_y - 0.5f, axis_v, position));
    if (light->type == LIGHT_DISK) {
        float16 disk_x, disk_y;
        lanes_disk(square_x, square_y, &disk_x, &disk_y);
        return lanes_fma(disk_x, axis_u, lanes_fma(disk_y, axis_v, position));
    }
    if (light->radius == 0.0f) return position;
    const float16 z = fma(square_x, (float16)(-2.0f), (float16)(1.0f));
    const float16 sine = sqrt(positive16(fma(-z, z, (float16)(1.0f))));
    float16 around_x, around_y;
    lanes_cos_sin(square_y, &around_x, &around_y);
    const Lanes3 on_unit_ball = {around_x * sine, around_y * sine, z};
    return lanes_fma((float16)(light->radius), on_unit_ball, position);
}

/// Sample `light_sample` of a light, seen from p: for each lane on its path of its camera sample.
/// `light_position` receives the sample's point, for shading at other points.
static inline LightSample sample_light(global const LightRecord* light, LightSlot slot, Lanes3 p, uint16 sample,
                                       uint16 path, Lanes3* light_position) {
    *light_position = lanes_of(load3(light->position));
    if (light->type == LIGHT_DIRECTIONAL) {
        const LightSample s = {lanes_of(-load3(light->normal)), (float16)(INFINITY),
                               lanes_of(load3(light->intensity) / (float)light->samples)};
        return s;
    }
    float16 square_x = (float16)(0.5f), square_y = (float16)(0.5f);
    if (light->type >= LIGHT_RECTANGLE || light->radius > 0.0f) {
        const uint16 index = sample * light->samples + slot.sample;
        stratified_samples(index, path, RANDOM_LIGHT + slot.light, &square_x, &square_y);
    }
    if (light->type == LIGHT_SPHERE) {
        const LightSample s = from_sphere(light, p, square_x, square_y);
        *light_position = lanes_fma(s.distance, s.direction, p);
        return s;
    }
    *light_position = light_point(light, square_x, square_y);
    if (light->type == LIGHT_RECTANGLE || light->type == LIGHT_DISK) return from_area(light, *light_position, p);
    return from_position(light, *light_position, p);
}

#endif
