// The sRGB transfer function in 8 bits. Source: IEC 61966-2-1:1999, section 5.2.
#pragma once

#include <cstdint>

namespace raymill {

/// The code in [0, 255] nearest to the sRGB encoding of a linear value, clamped to [0, 1]; NaN gives 0.
std::uint8_t srgb_code(double linear);

}  // namespace raymill
