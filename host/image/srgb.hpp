// The sRGB transfer function in 8 bits. Source: IEC 61966-2-1:1999, section 5.2.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace raymill {

/// The code in [0, 255] nearest to the sRGB encoding of a linear value, clamped to [0, 1]; NaN gives 0.
std::uint8_t srgb_code(double linear);

/// The same for many values, of floats, by a table instead of a power each.
class SrgbEncoder {
  public:
    SrgbEncoder();

    std::uint8_t code(float linear) const {
        if (!(linear > 0)) return 0;
        if (linear >= 1) return 255;
        const std::uint8_t first = first_[std::bit_cast<std::uint32_t>(linear) >> interval_bits];
        return static_cast<std::uint8_t>(first + (linear >= least_[first + 1u]));
    }

  private:
    // An interval is the floats whose upper bits are equal: so few that at most two codes are among them.
    static constexpr int interval_bits = 16;
    static constexpr std::size_t intervals = std::bit_cast<std::uint32_t>(1.0f) >> interval_bits;

    std::array<float, 257> least_;                 // the least float of each code; infinite after the last
    std::array<std::uint8_t, intervals> first_{};  // code of the least float of each interval
};

}  // namespace raymill
