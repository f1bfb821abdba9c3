// What rays see that miss everything: a colour, or a lat-long image around the scene.
#ifndef RAYMILL_ENVIRONMENT_H
#define RAYMILL_ENVIRONMENT_H

#include "lib/gather.h"

/// Texels of a lat-long image: columns wrap around, rows stop at the poles.
static inline Lanes3 environment_texels(Texture image, global const float* texels, int16 x, int16 y) {
    const int width = (int)image.width;
    const int16 column = select(select(x, x - width, x >= width), x + width, x < 0);
    // Vectors, since Oclgrind 21.10 reads fifteen more lanes of a scalar bound.
    const int16 row = clamp(y, (int16)(0), (int16)((int)image.height - 1));
    const uint16 index = as_uint16(row * width + column);
    global const float* first = texels + 3ul * image.first;
    const Lanes3 r = {gather1(first, 3, index), gather1(first + 1, 3, index), gather1(first + 2, 3, index)};
    return r;
}

/// Radiance from far away along the unit vectors d. In a lat-long image +y is the top row and +z the middle column,
/// with +x to its left: OpenEXR's convention for environment maps.
static inline Lanes3 environment_radiance(global const Texture* textures, global const float* texels,
                                          constant SceneConstants* constants, Lanes3 d) {
    const Lanes3 background = lanes_of(constant3(constants->background));
    if (constants->environment == NO_INDEX) return background;
    const Texture image = textures[constants->environment];
    const float16 u = fma(lanes_angle(d.x, d.z), (float16)(-0.5f / PI), (float16)(0.5f));
    const float16 v = lanes_angle(sqrt(fma(d.x, d.x, d.z * d.z)), d.y) / PI;
    const float16 x = fma(u, (float16)((float)image.width), (float16)(-0.5f));
    const float16 y = fma(v, (float16)((float)image.height), (float16)(-0.5f));
    const float16 x0 = floor(x), y0 = floor(y);
    const int16 i = convert_int16(x0), j = convert_int16(y0);
    const Lanes3 a = environment_texels(image, texels, i, j), b = environment_texels(image, texels, i + 1, j);
    const Lanes3 c = environment_texels(image, texels, i, j + 1), e = environment_texels(image, texels, i + 1, j + 1);
    const Lanes3 top = lanes_fma(x - x0, lanes_sub(b, a), a), bottom = lanes_fma(x - x0, lanes_sub(e, c), c);
    const Lanes3 sky = lanes_fma(y - y0, lanes_sub(bottom, top), top);
    return lanes_add(background, lanes_mul(sky, lanes_of(constant3(constants->environment_scale))));
}

#endif
