// Camera samples to camera rays.
// Reads:  nothing but the camera.
// Writes: rays [0, count).
// Next:   intersect.

#include "lib/camera.h"

/// One work-item a ray: camera samples [first_sample, first_sample + count) in tile order.
kernel void generate(ulong first_sample, uint count, constant CameraRecord* camera, global Ray* rays) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const CameraSample s = camera_sample_at(first_sample + i, camera);
    float3 origin, direction;
    camera_ray(camera, s, &origin, &direction);

    global Ray* ray = rays + i;
    store3(ray->origin, origin);
    store3(ray->direction, direction);
    store3(ray->throughput, (float3)(1.0f));
    ray->pixel = s.pixel;
    ray->sample = s.sample;
    ray->path = s.path;
    ray->route = ROUTE_CAMERA;
}
