// Random points as the kernels draw them, and the shapes that they are mapped to.
#pragma once

#include <cmath>
#include <utility>

#include "frames/world.hpp"
#include "lib/random.h"

namespace raymill::bench {

inline constexpr float PI = 3.14159265358979f;

/// Point `index` of the stratified points of [0, 1)^2 for one purpose (dimension) of one path.
inline vec2 stratified_sample(std::uint32_t index, std::uint32_t path, std::uint32_t dimension) {
    std::uint32_t x, y;
    stratified_point(index, random_key(path, dimension), &x, &y);
    return vec2(static_cast<float>(x), static_cast<float>(y)) * 0x1p-24f;
}

/// The unit square to the unit disk: Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997.
inline vec2 concentric_disk(const vec2& square) {
    const float a = 2 * square.x - 1, b = 2 * square.y - 1;
    if (a == 0 && b == 0) return vec2(0);
    const bool wide = std::abs(a) > std::abs(b);
    const float angle = wide ? b / a * (PI / 4) : PI / 2 - a / b * (PI / 4);
    return (wide ? a : b) * vec2(std::cos(angle), std::sin(angle));
}

/// Two unit vectors square to n: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
inline std::pair<vec3, vec3> tangents(const vec3& n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z), b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

}  // namespace raymill::bench
