#include "reference/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace raymill::reference {

namespace {

struct Point {
    double x;
    double y;
};

/// Twice the signed area of (0, p, q): which side of the edge p-q the ray passes on. Swapping p and q negates it
/// exactly.
double edge(const Point& p, const Point& q) {
    return p.x * q.y - p.y * q.x;
}

int sign(double x) {
    return (x > 0) - (x < 0);
}

/// The sign of edge(p, q) for a ray moved by (e, e^2), e infinitesimal: then
/// edge = p.x q.y - p.y q.x + e (p.y - q.y) + e^2 (q.x - p.x), whose first term that is not zero decides.
int perturbed_sign(double area, const Point& p, const Point& q) {
    if (area != 0) return sign(area);
    if (p.y != q.y) return sign(p.y - q.y);
    return sign(q.x - p.x);
}

}  // namespace

Caster::Caster(const dvec3& origin, const dvec3& direction) : origin_(origin), direction_(direction) {
    const dvec3 size = glm::abs(direction);
    kz_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    kx_ = (kz_ + 1) % 3;
    ky_ = (kx_ + 1) % 3;
    if (direction[kz_] < 0) std::swap(kx_, ky_);
    shear_ = {direction[kx_] / direction[kz_], direction[ky_] / direction[kz_], 1 / direction[kz_]};
}

std::optional<TriangleHit> Caster::triangle(const std::array<dvec3, 3>& vertices, Border border) const {
    Point p[3];
    double z[3];
    for (int i = 0; i < 3; ++i) {
        const dvec3 q = vertices[i] - origin_;
        p[i] = {q[kx_] - shear_.x * q[kz_], q[ky_] - shear_.y * q[kz_]};
        z[i] = shear_.z * q[kz_];
    }
    // weight[i] is the area across from vertex i.
    const double weight[3] = {edge(p[2], p[1]), edge(p[0], p[2]), edge(p[1], p[0])};
    const bool negative = weight[0] < 0 || weight[1] < 0 || weight[2] < 0;
    const bool positive = weight[0] > 0 || weight[1] > 0 || weight[2] > 0;
    if (negative && positive) return std::nullopt;
    const double area = weight[0] + weight[1] + weight[2];
    if (area == 0) return std::nullopt;
    if (border == Border::crossing) {
        const int side = sign(area);
        for (int i = 0; i < 3; ++i) {
            if (perturbed_sign(weight[i], p[(i + 2) % 3], p[(i + 1) % 3]) != side) return std::nullopt;
        }
    }
    const double t = (weight[0] * z[0] + weight[1] * z[1] + weight[2] * z[2]) / area;
    return TriangleHit{t, weight[1] / area, weight[2] / area};
}

std::optional<SphereHits> Caster::sphere(const dvec3& center, double radius) const {
    const dvec3 f = origin_ - center;
    const double a = glm::dot(direction_, direction_);
    const double b = -glm::dot(f, direction_);
    // The centre's distance from the line rather than b^2 - a c, which cancels for distant spheres.
    const dvec3 closest = f + b / a * direction_;
    const double discriminant = radius * radius - glm::dot(closest, closest);
    if (!(discriminant >= 0)) return std::nullopt;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    if (q == 0) return SphereHits{0, 0};
    const double distance = glm::length(f);
    const double c = (distance - radius) * (distance + radius);
    const auto [near, far] = std::minmax({c / q, q / a});
    return SphereHits{near, far};
}

std::optional<double> Caster::plane(const dvec3& point, const dvec3& normal) const {
    const double slope = glm::dot(direction_, normal);
    if (slope == 0) return std::nullopt;
    return glm::dot(point - origin_, normal) / slope;
}

}  // namespace raymill::reference
