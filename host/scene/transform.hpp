// Affine transforms of objects: scale, rotate about x, y, z, translate, then a matrix.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace raymill {

/// An invertible affine map from an object's space to the world. Vectors are columns: p' = M p.
class Transform {
  public:
    Transform() = default;
    explicit Transform(const glm::dmat4& matrix);

    /// This transform after another one.
    Transform after(const glm::dmat4& first) const;

    /// Without a transform p itself, so that one infinite coordinate does not spoil the others.
    glm::dvec3 point(const glm::dvec3& p) const { return identity_ ? p : linear_ * p + offset_; }
    /// Unit normal by the inverse transpose; zero for a zero or not finite normal. Outside stays outside.
    glm::dvec3 normal(const glm::dvec3& n) const;
    /// Whether left and right are swapped, so that a counter-clockwise face becomes clockwise.
    bool mirrors() const { return glm::determinant(linear_) < 0; }
    /// By how much all lengths grow, if all grow alike (to a relative 1e-9): then a sphere stays a sphere.
    std::optional<double> uniform_scale() const;
    /// An upper bound on by how much any length grows: the largest singular value.
    double largest_stretch() const;

  private:
    bool identity_ = true;
    glm::dmat3 linear_{1};
    glm::dvec3 offset_{0};
    glm::dmat3 inverse_transpose_{1};
};

/// The linear map of `scale`, then rotations about x, then y, then z by `degrees`, then `translate`, then `matrix`.
glm::dmat4 compose_transform(const glm::dvec3& scale, const glm::dvec3& degrees, const glm::dvec3& translate,
                             const glm::dmat4& matrix);

}  // namespace raymill
