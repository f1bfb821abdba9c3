// Camera samples in tile order, and the rays they start.
#ifndef RAYMILL_CAMERA_H
#define RAYMILL_CAMERA_H

#include "lib/sampling.h"

typedef struct {
    uint x, y;    // in the whole image, from the top left
    uint pixel;   // in the rendered window
    uint sample;  // in [0, spp)
    uint path;
} CameraSample;

/// Sample number `index` of the window: tiles of TILE x TILE pixels row by row, in a tile all pixels of one sample after
/// the other, so that 64 rays in a row are neighbours. Tiles at the right and bottom edge are smaller; none is padded.
static inline CameraSample camera_sample_at(ulong index, constant CameraRecord* camera) {
    const uint width = camera->crop[2], height = camera->crop[3], spp = camera->spp;
    const ulong row_samples = (ulong)width * TILE * spp;
    const uint tile_y = (uint)(index / row_samples) * TILE;
    const uint rows = min((uint)TILE, height - tile_y);
    const ulong in_row = index - (ulong)tile_y * width * spp;  // a row of tiles may hold more than 2^32

    const uint full_tile = TILE * rows * spp;
    const uint tile_x = (uint)(in_row / full_tile) * TILE;
    const uint columns = min((uint)TILE, width - tile_x);
    const uint in_tile = (uint)(in_row - (ulong)(tile_x / TILE) * full_tile);

    const uint tile_pixels = columns * rows;
    const bool whole = tile_pixels == TILE * TILE;  // divisions by constants
    const uint sample = whole ? in_tile / (TILE * TILE) : in_tile / tile_pixels;
    const uint in_sample = in_tile - sample * tile_pixels;
    const uint row = whole ? in_sample / TILE : in_sample / columns;
    const uint x = tile_x + in_sample - row * columns;
    const uint y = tile_y + row;

    CameraSample s;
    s.x = camera->crop[0] + x;
    s.y = camera->crop[1] + y;
    s.pixel = y * width + x;
    s.sample = sample;
    s.path = path_camera(camera->seed, s.y * camera->width + s.x);
    return s;
}

/// The ray through the sample's point of the film plane: the pixel's centre with one sample, stratified with more;
/// through a point of the lens if there is one. direction is unit.
static inline void camera_ray(constant CameraRecord* camera, CameraSample s, float3* origin, float3* direction) {
    const float2 jitter =
        camera->spp == 1 ? (float2)(0.5f) : stratified_sample(s.sample, s.path, RANDOM_PIXEL);
    const float x = fma(((float)s.x + jitter.x) / (float)camera->width, 2.0f, -1.0f);
    const float y = fma(((float)s.y + jitter.y) / (float)camera->height, -2.0f, 1.0f);
    const float3 eye = constant3(camera->eye), forward = constant3(camera->forward);
    const float3 across = fma3(x, constant3(camera->right), constant3(camera->up) * y);

    float3 from = camera->orthographic ? eye + across : eye;
    float3 along = camera->orthographic ? forward : forward + across;
    if (camera->lens_radius > 0.0f) {
        const float2 lens = concentric_disk(stratified_sample(s.sample, s.path, RANDOM_LENS));
        const float3 shift =
            fma3(lens.x, unit3(constant3(camera->right)), unit3(constant3(camera->up)) * lens.y) * camera->lens_radius;
        from += shift;
        along = fma3(camera->focus, along, -shift);
    }
    *origin = from;
    *direction = unit3(along);
}

#endif
