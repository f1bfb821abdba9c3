#include "verify/crossing.hpp"

#include <algorithm>
#include <cmath>

#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

double largest(double a, double b, double c) {
    return std::max({std::abs(a), std::abs(b), std::abs(c)});
}

/// A triangle's corners in the frame in which the ray is the z axis (Woop, Benthin, Wald 2013), and their sizes.
struct Sheared {
    double x[3], y[3], z[3];
    double along;  // the direction's largest component
    double size_x, size_y, size_z;
};

Sheared shear(const Scene& scene, const reference::Ray& ray, const Triangle& triangle) {
    const dvec3 size = glm::abs(ray.direction);
    const int kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
    Sheared s{};
    s.along = ray.direction[kz];
    for (int i = 0; i < 3; ++i) {
        const dvec3 p = reference::to_dvec3(scene.vertices[triangle.vertex[i]].position) - ray.origin;
        s.x[i] = p[kx] - ray.direction[kx] / s.along * p[kz];
        s.y[i] = p[ky] - ray.direction[ky] / s.along * p[kz];
        s.z[i] = p[kz];
    }
    s.size_x = largest(s.x[0], s.x[1], s.x[2]);
    s.size_y = largest(s.y[0], s.y[1], s.y[2]);
    s.size_z = largest(s.z[0], s.z[1], s.z[2]);
    return s;
}

std::vector<Crossing> triangle_crossing(const Scene& scene, const reference::Ray& ray, const Triangle& triangle) {
    const Sheared s = shear(scene, ray, triangle);
    double area[3], total = 0, distance = 0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 2) % 3, k = (i + 1) % 3;
        area[i] = s.x[j] * s.y[k] - s.y[j] * s.x[k];
        total += area[i];
        distance += area[i] * s.z[i];
    }
    // One rounding of the difference, two of the shear, one of each product and sum.
    const double x_error = 5 * rounding * (s.size_x + s.size_z), y_error = 5 * rounding * (s.size_y + s.size_z);
    const double size = largest(area[0], area[1], area[2]);
    const double area_error = 2 * (2 * rounding * s.size_x * s.size_y + y_error * s.size_x + x_error * s.size_y);
    Crossing c;
    if (std::abs(total) <= 3 * area_error) {
        // Seen edge on: nothing of what single precision makes of it is certain.
        c.t_error = c.weight_error = c.margin_error = INFINITY;
        return {c};
    }
    const double inverse = 1 / std::abs(total);
    c.t = distance / total / s.along;
    c.u = area[1] / total;
    c.v = area[2] / total;
    c.margin = std::min({area[0] / total, c.u, c.v});
    const double per_along = s.size_z / std::abs(s.along);
    c.t_error = 3 * (9 * rounding * size + area_error) * per_along * inverse + 2 * rounding * std::abs(c.t);
    // The kernel leaves out hits nearer than its own bound (triangle.h), of what it has computed so far.
    const double x = s.size_x + x_error, y = s.size_y + y_error, least = std::abs(total) - 3 * area_error;
    c.left_out = 3 * per_along * rounding * (2 * (12 * x * y + 5 * s.size_z * (x + y)) / least + 6);
    // Of the quotient: the numerator's error, three times that in the denominator, and two roundings.
    c.weight_error = area_error * inverse * (1 + 3 * std::max(1.0, size * inverse)) + 5 * rounding * size * inverse;
    // The kernel decides by the sign of each area, which is exact where the rounded one is zero.
    c.margin_error = area_error * inverse;
    return {c};
}

std::vector<Crossing> sphere_crossings(const reference::Ray& ray, const Sphere& sphere) {
    const dvec3 f = ray.origin - reference::to_dvec3(sphere.center), d = ray.direction;
    const double radius = sphere.radius, r2 = radius * radius;
    const double a = glm::dot(d, d), b = -glm::dot(f, d), f2 = glm::dot(f, f);
    const dvec3 p = f + b / a * d;
    const double p2 = glm::dot(p, p), discriminant = r2 - p2;
    // b has four roundings of |f||d|, the perpendicular p two more of |f|; its square and the difference the rest.
    const double b_error = 4 * rounding * std::sqrt(f2 * a);
    const double discriminant_error =
        rounding * (2 * r2 + 4 * p2 + 2 * std::sqrt(p2) * 8 * std::sqrt(f2)) + 64 * rounding * rounding * f2;
    Crossing c;
    c.margin = discriminant / r2;
    c.margin_error = discriminant_error / r2;
    if (c.margin < -c.margin_error) return {};
    const double root = std::sqrt(a * std::max(discriminant, 0.0));
    const double root_error =
        std::min(a * discriminant_error / std::max(root, 1e-300), std::sqrt(a * discriminant_error)) + rounding * root;
    const double q = b + std::copysign(root, b);
    const double q_error = b_error + root_error + rounding * std::abs(q);
    const double distance = std::sqrt(f2);
    const double k = (distance - radius) * (distance + radius);
    const double k_error = rounding * (4 * f2 + 2 * r2);
    const double least = std::max(std::abs(q) - q_error, 1e-300);  // of |q| in the kernel
    Crossing by_product = c, by_root = c;
    by_product.t = q != 0 ? k / q : 0;
    by_product.t_error = k_error / least + std::abs(by_product.t) * (q_error / least + rounding);
    by_root.t = q / a;
    by_root.t_error = q_error / a + 5 * rounding * std::abs(by_root.t);
    if (by_product.t > by_root.t) std::swap(by_product, by_root);
    return {by_product, by_root};
}

std::vector<Crossing> plane_crossing(const reference::Ray& ray, const Plane& plane) {
    const dvec3 n = reference::to_dvec3(plane.normal), from = ray.origin - reference::to_dvec3(plane.point);
    const double slope = glm::dot(n, ray.direction);
    Crossing c;
    c.margin = std::abs(slope);
    c.margin_error = 4 * rounding;  // an inner product of unit vectors
    if (slope == 0) {
        c.t_error = INFINITY;
        return {c};
    }
    c.t = -glm::dot(n, from) / slope;
    const double least = std::max(c.margin - c.margin_error, 1e-300);
    c.t_error = (5 * rounding * glm::length(from) + std::abs(c.t) * c.margin_error) / least + rounding * std::abs(c.t);
    return {c};
}

}  // namespace

double Crossing::clarity() const {
    const double by_margin = margin_error > 0 ? std::abs(margin) / margin_error : INFINITY;
    const double near = t_error + (t > 0 ? left_out : 0);
    const double by_distance = near > 0 ? std::abs(t) / near : INFINITY;
    // Outside either of them is enough to be no hit; inside both are needed to be one.
    if (margin < 0 && t < 0) return std::max(by_margin, by_distance);
    if (margin < 0) return by_margin;
    if (t < 0) return by_distance;
    return std::min(by_margin, by_distance);
}

std::vector<Crossing> crossings(const Scene& scene, const reference::Ray& ray, std::uint32_t primitive) {
    if (is_triangle(scene, primitive)) return triangle_crossing(scene, ray, scene.triangles[primitive]);
    if (const Sphere* sphere = sphere_of(scene, primitive)) return sphere_crossings(ray, *sphere);
    return plane_crossing(ray, *plane_of(scene, primitive));
}

const Crossing* nearest(const std::vector<Crossing>& all, double t) {
    const auto further = [t](const Crossing& a, const Crossing& b) { return std::abs(a.t - t) < std::abs(b.t - t); };
    const auto best = std::min_element(all.begin(), all.end(), further);
    return best == all.end() ? nullptr : &*best;
}

}  // namespace raymill::verify
