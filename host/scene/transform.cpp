#include "scene/transform.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace raymill {

Transform::Transform(const glm::dmat4& matrix)
    : identity_(matrix == glm::dmat4(1)),
      linear_(matrix),
      offset_(matrix[3]),
      inverse_transpose_(glm::transpose(glm::inverse(linear_))) {}

Transform Transform::after(const glm::dmat4& first) const {
    glm::dmat4 matrix(linear_);
    matrix[3] = glm::dvec4(offset_, 1);
    return Transform(matrix * first);
}

glm::dvec3 Transform::normal(const glm::dvec3& n) const {
    const glm::dvec3 transformed = inverse_transpose_ * n;
    const double length = glm::length(transformed);
    return length > 0 && std::isfinite(length) ? transformed / length : glm::dvec3(0);
}

std::optional<double> Transform::uniform_scale() const {
    const glm::dmat3 gram = glm::transpose(linear_) * linear_;
    const double square = (gram[0][0] + gram[1][1] + gram[2][2]) / 3;
    constexpr double tolerance = 1e-9;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (std::abs(gram[i][j] - (i == j ? square : 0)) > tolerance * square) return std::nullopt;
    return std::sqrt(square);
}

double Transform::largest_stretch() const {
    // Gershgorin: no eigenvalue of the Gram matrix exceeds its largest absolute row sum; exact where axes stay
    // orthogonal.
    const glm::dmat3 gram = glm::transpose(linear_) * linear_;
    double bound = 0;
    for (int i = 0; i < 3; ++i)
        bound = std::max(bound, std::abs(gram[i][0]) + std::abs(gram[i][1]) + std::abs(gram[i][2]));
    return std::sqrt(bound);
}

glm::dmat4 compose_transform(const glm::dvec3& scale, const glm::dvec3& degrees, const glm::dvec3& translate,
                             const glm::dmat4& matrix) {
    glm::dmat4 result = matrix * glm::translate(glm::dmat4(1), translate);
    for (int axis = 2; axis >= 0; --axis) {
        // Quarter turns are exact, so that an axis-aligned box stays one.
        const double turns = std::remainder(degrees[axis], 360) / 90;
        const bool quarter = turns == std::nearbyint(turns);
        const double angle = glm::radians(degrees[axis]);
        const double c = quarter ? std::nearbyint(std::cos(angle)) : std::cos(angle);
        const double s = quarter ? std::nearbyint(std::sin(angle)) : std::sin(angle);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        glm::dmat4 rotation(1);
        rotation[u][u] = c;
        rotation[u][v] = s;
        rotation[v][u] = -s;
        rotation[v][v] = c;
        result = result * rotation;
    }
    return result * glm::scale(glm::dmat4(1), scale);
}

}  // namespace raymill
