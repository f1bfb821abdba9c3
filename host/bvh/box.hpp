// Axis-aligned boxes in four-lane vectors: the arithmetic of the builder's inner loops.
// GCC's and Clang's vector extension, so that the same source is SSE on x86-64 and NEON on ARM.
#pragma once

#include <cmath>
#include <cstdint>

namespace raymill::bvh {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Float4 min(Float4 a, Float4 b) {
    return a < b ? a : b;
}
inline Float4 max(Float4 a, Float4 b) {
    return a > b ? a : b;
}

/// All four lanes alike.
inline Float4 splat(float x) {
    return Float4{x, x, x, x};
}

/// Lanes 0 to 2 as they are, lane 3 zero: ids read as floats are denormal, and slow to compute with.
inline Float4 xyz(Float4 v) {
    const Int4 keep = {-1, -1, -1, 0};
    return reinterpret_cast<Float4>(reinterpret_cast<Int4>(v) & keep);
}

/// x, y, z in lanes 0 to 2, lane 3 is not part of it. Empty while lower > upper.
struct Box {
    Float4 lower = splat(INFINITY);
    Float4 upper = splat(-INFINITY);

    void add(const Box& other) {
        lower = min(lower, other.lower);
        upper = max(upper, other.upper);
    }
    void add(Float4 point) {
        lower = min(lower, point);
        upper = max(upper, point);
    }
    /// Only where all bits of the mask are set; the others are zero.
    void add_where(Int4 mask, Float4 point) {
        lower = min(lower, mask ? point : splat(INFINITY));
        upper = max(upper, mask ? point : splat(-INFINITY));
    }
};

/// Half the surface area of a box that is not empty. In double: squares of float extents neither overflow nor vanish.
inline double half_area(const float* lower, const float* upper) {
    const double x = static_cast<double>(upper[0]) - lower[0];
    const double y = static_cast<double>(upper[1]) - lower[1];
    const double z = static_cast<double>(upper[2]) - lower[2];
    return x * (y + z) + y * z;
}

}  // namespace raymill::bvh
