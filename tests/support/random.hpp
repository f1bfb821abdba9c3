// Reproducible random numbers for tests: the standard's distributions differ between libraries, its engines do not.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <random>

namespace raymill::test {

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}

    std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }
    std::uint32_t below(std::uint32_t count) { return bits() % count; }
    /// Uniform in [low, high), of 24 bits.
    float in(float low, float high) { return low + (high - low) * static_cast<float>(bits() >> 8) * 0x1p-24f; }
    glm::vec3 in_cube(float low, float high) {
        const float x = in(low, high), y = in(low, high), z = in(low, high);
        return {x, y, z};
    }
    /// Uniform on the unit sphere, rounded.
    glm::vec3 direction() {
        const double z = 2.0 * in(0, 1) - 1, azimuth = 6.283185307179586 * in(0, 1);
        const double radius = std::sqrt(1 - z * z);
        return glm::vec3(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    }

  private:
    std::mt19937 engine_;
};

}  // namespace raymill::test
