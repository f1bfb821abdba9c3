// How far two pictures are apart.
#pragma once

#include <span>

namespace raymill::bench {

/// Pictures that differ by more are not of the same scene: rounding moves edges of shadows, of checkers and of total
/// reflection by a ray here and there, which at one sample a pixel came to 1.2e-4 and 2.4e-4 in the worst of our
/// scenes.
inline constexpr double ALLOWED_MEAN = 1e-3;
inline constexpr double ALLOWED_PIXELS = 2e-3;

struct PictureDifference {
    double mean = 0;    // mean absolute difference of all channels, over their mean
    double pixels = 0;  // share of pixels of which a channel is off by more than 1/50 of itself plus of the mean

    bool allowed() const { return mean <= ALLOWED_MEAN && pixels <= ALLOWED_PIXELS; }
};

/// Both RGBA, of the same size, not empty. What is not a number differs.
PictureDifference difference(std::span<const float> picture, std::span<const float> expected);

}  // namespace raymill::bench
