// Colours as files write them.
#pragma once

#include <cmath>

namespace raymill {

/// sRGB's transfer function, IEC 61966-2-1. encoded in [0, 1].
inline double srgb_to_linear(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace raymill
