// Camera samples to camera rays.
// Reads:  nothing but the camera.
// Writes: rays [0, count).
// Next:   intersect.

#include "lib/camera.h"
#include "lib/gather.h"

static inline void write_rays(const CameraSamples* s, Lanes3 from, Lanes3 along, uint count, global Ray* rays) {
    const Rows origin = rows_of(from, as_float16(s->pixel));
    const Rows direction = rows_of(along, as_float16(s->sample));
    for (uint lane = 0; lane < count; ++lane) {
        global Ray* ray = rays + lane;
        store_row(ray->origin, row_of(&origin, lane));
        store_row(ray->direction, row_of(&direction, lane));
        store_row(ray->throughput, (float4)(1.0f, 1.0f, 1.0f, as_float(((const uint*)&s->path)[lane])));
        ray->route = ROUTE_CAMERA;
    }
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
        write_rays(&samples, from, along, min((uint)LANES, end - first), rays + first);
    }
}
