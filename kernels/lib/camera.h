// Camera samples in tile order, and the rays they start.
#ifndef RAYMILL_CAMERA_H
#define RAYMILL_CAMERA_H

#include "lib/sampling.h"

/// A place in the order of camera samples: whole tiles of TILE x TILE pixels row by row, then those that are left at
/// the right edge from top to bottom, then those at the bottom from left to right, as wide and high as there is room;
/// none is padded. In a tile the pixels come one after the other, each with all its samples, in a whole tile in
/// Z-order. So 64 rays in a row are neighbours, and sixteen are closer ones, the closer the more samples a pixel has;
/// the film adds those of one pixel at once; and narrow tiles do not put the whole ones out of step with the chunks.
typedef struct {
    uint tile_x, tile_y;  // first pixel of the tile, in the rendered window
    uint columns, rows;   // of the tile
    uint place;           // of the pixel in the tile
    uint sample;          // in [0, spp)
} CameraCursor;

static inline void set_tile(CameraCursor* c, constant CameraRecord* camera, uint x, uint y) {
    c->tile_x = x;
    c->tile_y = y;
    c->columns = min((uint)TILE, camera->crop[2] - x);
    c->rows = min((uint)TILE, camera->crop[3] - y);
}

/// Quotient, which must be below 2^32, and remainder.
static inline uint divide(ulong number, uint by, uint* remainder) {
    const uint quotient = (uint)(number / by);
    *remainder = (uint)(number - (ulong)quotient * by);
    return quotient;
}

/// Camera sample number `index` of the window, which must have it.
static inline CameraCursor camera_cursor(ulong index, constant CameraRecord* camera) {
    const uint width = camera->crop[2], height = camera->crop[3], spp = camera->spp;
    const uint across = width / TILE, down = height / TILE;            // whole tiles
    const uint columns = width % TILE, rows = height % TILE;           // what is left
    const ulong right = (ulong)(across * TILE) * (down * TILE) * spp;  // the first sample at the right edge
    const ulong bottom = right + (ulong)columns * (down * TILE) * spp;
    CameraCursor c;
    uint in_tile;
    if (index < right) {
        const uint tile = divide(index, TILE * TILE * spp, &in_tile);
        set_tile(&c, camera, tile % across * TILE, tile / across * TILE);
    } else if (index < bottom) {
        const uint tile = divide(index - right, columns * TILE * spp, &in_tile);
        set_tile(&c, camera, across * TILE, tile * TILE);
    } else {
        const uint tile = divide(index - bottom, TILE * rows * spp, &in_tile);
        set_tile(&c, camera, tile * TILE, down * TILE);
    }
    c.place = divide(in_tile, spp, &c.sample);
    return c;
}

static inline void next_tile(CameraCursor* c, constant CameraRecord* camera) {
    const uint width = camera->crop[2], height = camera->crop[3];
    const uint right = width - width % TILE, bottom = height - height % TILE;  // where whole tiles end
    uint x = c->tile_x, y = c->tile_y;
    if (y >= bottom) {
        x += TILE;
    } else if (x >= right) {
        y += TILE;
        if (y >= bottom) x = 0;
    } else {
        x += TILE;
        if (x >= right) {
            x = 0;
            y += TILE;
        }
        if (y >= bottom && right < width) {
            x = right;
            y = 0;
        }
    }
    set_tile(c, camera, x, y);
}

/// The next sample. Past the last one it means nothing.
static inline void camera_step(CameraCursor* c, constant CameraRecord* camera) {
    if (++c->sample < camera->spp) return;
    c->sample = 0;
    if (++c->place < c->columns * c->rows) return;
    c->place = 0;
    next_tile(c, camera);
}

/// Sixteen camera samples.
typedef struct {
    uint16 x, y;   // in the whole image, from the top left
    uint16 pixel;  // in the rendered window
    uint16 sample;
    uint16 path;
} CameraSamples;

/// Bits 0, 2 and 4: the column of a place in Z-order.
static inline uint16 every_other_bit(uint16 place) { return (place & 1u) | (place >> 1 & 2u) | (place >> 2 & 4u); }

/// Takes the next samples, which lie in one whole tile.
static inline void samples_of_tile(CameraCursor* cursor, constant CameraRecord* camera, CameraSamples* s) {
    const uint spp = camera->spp;
    const uint16 sample = cursor->sample + (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    // sample / spp: at most 1 if a pixel has sixteen samples and more; else of a number below 32, where 16 bits of the
    // reciprocal, rounded up, will do.
    const uint16 pixels = spp < LANES ? sample * (65536 / spp + 1) >> 16 : as_uint16(sample >= spp) & 1u;
    const uint16 place = cursor->place + pixels;
    s->x = cursor->tile_x + every_other_bit(place);
    s->y = cursor->tile_y + every_other_bit(place >> 1);
    s->sample = sample - pixels * spp;
    cursor->place = place.sf;
    cursor->sample = s->sample.sf;
    camera_step(cursor, camera);
}

/// Takes the next samples one by one.
static inline void samples_of_tiles(CameraCursor* cursor, constant CameraRecord* camera, CameraSamples* s) {
    uint x[LANES], y[LANES], sample[LANES];
    for (uint lane = 0; lane < LANES; ++lane) {
        const bool whole = cursor->columns * cursor->rows == TILE * TILE;
        const uint16 place = (uint16)(cursor->place);
        const uint columns = max(cursor->columns, 1u);  // past the last sample there may be none
        x[lane] = cursor->tile_x + (whole ? every_other_bit(place).s0 : cursor->place % columns);
        y[lane] = cursor->tile_y + (whole ? every_other_bit(place >> 1).s0 : cursor->place / columns);
        sample[lane] = cursor->sample;
        camera_step(cursor, camera);
    }
    s->x = vload16(0, x);
    s->y = vload16(0, y);
    s->sample = vload16(0, sample);
}

/// Takes the next samples. A lane may lie past the last sample: its ray is not to be used.
COMPILED_ONCE static void camera_samples(CameraCursor* cursor, constant CameraRecord* camera, CameraSamples* s) {
    const uint left = (TILE * TILE - cursor->place) * camera->spp - cursor->sample;  // in a whole tile
    if (cursor->columns * cursor->rows == TILE * TILE && left >= LANES)
        samples_of_tile(cursor, camera, s);
    else
        samples_of_tiles(cursor, camera, s);
    s->pixel = s->y * camera->crop[2] + s->x;
    s->x += camera->crop[0];
    s->y += camera->crop[1];
    s->path = path_camera(camera->seed, s->y * camera->width + s->x);
}

/// The rays through the samples' points of the film plane: the pixel's centre with one sample, stratified with more;
/// through a point of the lens if there is one. Directions are unit.
COMPILED_ONCE static void camera_rays(constant CameraRecord* camera, const CameraSamples* s, Lanes3* origin,
                               Lanes3* direction) {
    float16 jitter_x = (float16)(0.5f), jitter_y = (float16)(0.5f);
    if (camera->spp != 1) stratified_samples(s->sample, s->path, RANDOM_PIXEL, &jitter_x, &jitter_y);
    const float16 column = convert_float16(as_int16(s->x)), row = convert_float16(as_int16(s->y));
    const float16 x = fma((column + jitter_x) / (float)camera->width, (float16)(2.0f), (float16)(-1.0f));
    const float16 y = fma((row + jitter_y) / (float)camera->height, (float16)(-2.0f), (float16)(1.0f));
    const float3 right = constant3(camera->right), up = constant3(camera->up);
    const Lanes3 eye = lanes_of(constant3(camera->eye)), forward = lanes_of(constant3(camera->forward));
    const Lanes3 across = lanes_fma(x, lanes_of(right), lanes_scale(lanes_of(up), y));

    Lanes3 from = camera->orthographic ? lanes_add(eye, across) : eye;
    Lanes3 along = camera->orthographic ? forward : lanes_add(forward, across);
    if (camera->lens_radius > 0.0f) {
        float16 lens_x, lens_y;
        stratified_samples(s->sample, s->path, RANDOM_LENS, &lens_x, &lens_y);
        lanes_disk(lens_x, lens_y, &lens_x, &lens_y);
        const Lanes3 on_disk = lanes_fma(lens_x, lanes_of(unit3(right)), lanes_scale(lanes_of(unit3(up)), lens_y));
        const Lanes3 shift = lanes_scale(on_disk, (float16)(camera->lens_radius));
        from = lanes_add(from, shift);
        along = lanes_fma((float16)(camera->focus), along, lanes_minus(shift));
    }
    *origin = from;
    *direction = lanes_unit(along);
}

#endif
