// Camera samples to camera rays.
// Reads:  nothing but the camera.
// Writes: rays [0, count).
// Next:   intersect.

#include "lib/camera.h"

static inline void write_ray(const CameraSamples* s, uint lane, float3 origin, float3 direction, global Ray* ray) {
    store3(ray->origin, origin);
    ray->pixel = s->pixel[lane];
    store3(ray->direction, direction);
    ray->sample = s->sample[lane];
    store3(ray->throughput, (float3)(1.0f));
    ray->path = s->path[lane];
    ray->route = ROUTE_CAMERA;
}

/// One work-item a chunk of CHUNK rays: camera samples [first_sample, first_sample + count) in tile order.
kernel void generate(ulong first_sample, uint count, constant CameraRecord* camera, global Ray* rays) {
    const uint begin = get_global_id(0) * CHUNK;
    const uint end = min(begin + CHUNK, count);
    if (begin >= count) return;
    CameraCursor cursor = camera_cursor(first_sample + begin, camera);
    for (uint first = begin; first < end; first += LANES) {
        CameraSamples samples;
        Lanes3 from, along;
        camera_samples(&cursor, camera, &samples);
        camera_rays(camera, &samples, &from, &along);
        float origin[3][LANES], direction[3][LANES];
        lanes_store(origin, from);
        lanes_store(direction, along);
        for (uint lane = 0; lane < min((uint)LANES, end - first); ++lane)
            write_ray(&samples, lane, lane_get(origin, lane), lane_get(direction, lane), rays + first + lane);
    }
}
