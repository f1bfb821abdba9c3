// Numbers with a bound on the error that single-precision arithmetic may make in them.
// Source: Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 3.3 (running error analysis).
#pragma once

#include <glm/glm.hpp>

namespace raymill::verify {

using glm::dvec3;

/// Relative error of one rounding to single precision: 2^-24.
inline constexpr double rounding = 0x1p-24;
/// Absolute error where a kernel's function gives 0 below the smallest normal number (2^-126).
inline constexpr double underflow = 0x1p-125;
/// Half a unit of the film: what the conversion of a contribution rounds by at most.
inline constexpr double film_rounding = 0x1p-33;
/// Length of a vector of three errors that are 1 at most.
inline constexpr double diagonal = 1.7320508075688772;

/// A colour, and how far from it the kernel's may be, channel by channel.
struct Bounded {
    dvec3 value{0};
    dvec3 error{0};
};

inline Bounded exact(const dvec3& value) {
    return {value, dvec3(0)};
}

/// The product, rounded once.
inline Bounded operator*(const Bounded& a, const Bounded& b) {
    const dvec3 value = a.value * b.value;
    return {value,
            glm::abs(a.value) * b.error + glm::abs(b.value) * a.error + a.error * b.error + rounding * glm::abs(value)};
}

inline bool any_beyond(const dvec3& value, const dvec3& error) {
    return glm::any(glm::greaterThan(glm::abs(value), error));
}

}  // namespace raymill::verify
