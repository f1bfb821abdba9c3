// What rays see that miss everything: a colour, or a lat-long image around the scene.
#ifndef RAYMILL_ENVIRONMENT_H
#define RAYMILL_ENVIRONMENT_H

#include "lib/math.h"

/// Texel of a lat-long image: columns wrap around, rows stop at the poles.
static inline float3 environment_texel(Texture image, global const float* texels, int x, int y) {
    const int w = (int)image.width;
    const int column = x < 0 ? x + w : x >= w ? x - w : x;
    const int row = clamp(y, 0, (int)image.height - 1);
    return load3(texels + 3ul * (image.first + (ulong)row * image.width + column));
}

/// Radiance from far away along the unit vector d. In a lat-long image +y is the top row and +z the middle column, with +x
/// to its left: OpenEXR's convention for environment maps.
static inline float3 environment_radiance(global const Texture* textures, global const float* texels,
                                          constant SceneConstants* constants, float3 d) {
    const float3 background = constant3(constants->background);
    if (constants->environment == NO_INDEX) return background;
    const Texture image = textures[constants->environment];
    const float u = fma(angle_of(d.x, d.z), -0.5f / PI, 0.5f);
    const float v = angle_of(sqrt(fma(d.x, d.x, d.z * d.z)), d.y) / PI;
    const float x = fma(u, (float)image.width, -0.5f), y = fma(v, (float)image.height, -0.5f);
    const float x0 = floor(x), y0 = floor(y);
    const float fx = x - x0, fy = y - y0;
    const int i = (int)x0, j = (int)y0;
    const float3 a = environment_texel(image, texels, i, j), b = environment_texel(image, texels, i + 1, j);
    const float3 c = environment_texel(image, texels, i, j + 1), e = environment_texel(image, texels, i + 1, j + 1);
    const float3 top = fma3(fx, b - a, a), bottom = fma3(fx, e - c, c);
    return background + fma3(fy, bottom - top, top) * constant3(constants->environment_scale);
}

#endif
