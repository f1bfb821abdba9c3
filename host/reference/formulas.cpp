#include "reference/formulas.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lib/random.h"

namespace raymill::reference {

namespace {

constexpr double pi = glm::pi<double>();

}  // namespace

Tangents tangents(const dvec3& n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    return {{1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

dvec2 concentric_disk(const dvec2& square) {
    const dvec2 p = 2.0 * square - 1.0;
    if (p.x == 0 && p.y == 0) return {0, 0};
    // The larger coordinate, with its sign, is the radius: a negative one turns the angle by pi.
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const double radius = wide ? p.x : p.y;
    const double angle = wide ? pi / 4 * (p.y / p.x) : pi / 2 - pi / 4 * (p.x / p.y);
    return radius * dvec2(std::cos(angle), std::sin(angle));
}

dvec2 stratified_square(std::uint32_t index, std::uint32_t key) {
    uint x = 0;
    uint y = 0;
    stratified_point(index, key, &x, &y);
    return dvec2(x, y) / 16777216.0;  // 24-bit fixed point
}

dvec3 uniform_sphere(const dvec2& square) {
    const double z = 1 - 2 * square.x;
    const double radius = std::sqrt(std::max(0.0, 1 - z * z));
    const double azimuth = 2 * pi * square.y;
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

dvec3 reflect(const dvec3& i, const dvec3& n) {
    return glm::normalize(i - 2 * glm::dot(i, n) * n);
}

std::optional<dvec3> refract(const dvec3& i, const dvec3& n, double eta) {
    if (eta == 1) return i;  // exactly, where the sum below would round
    const double cos_i = -glm::dot(i, n);
    const dvec3 tangential = (i + cos_i * n) / eta;
    const double sin2_t = glm::dot(tangential, tangential);
    if (sin2_t >= 1) return std::nullopt;
    return glm::normalize(tangential - std::sqrt(1 - sin2_t) * n);
}

double fresnel(double cos_i, double eta) {
    if (eta == 1) return 0;  // no boundary, also at grazing angles where the quotients below are 0 / 0
    const double sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    const double cos_t = std::sqrt(1 - sin2_t);
    const double parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const double perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return (parallel * parallel + perpendicular * perpendicular) / 2;
}

double phong_highlight(const dvec3& n, const dvec3& l, const dvec3& v, double shininess) {
    const dvec3 r = 2 * glm::dot(n, l) * n - l;
    return std::pow(std::max(glm::dot(v, r), 0.0), shininess);
}

double blinn_highlight(const dvec3& n, const dvec3& l, const dvec3& v, double shininess) {
    const dvec3 sum = l + v;
    const double length = glm::length(sum);
    const double cosine = length > 0 ? glm::dot(n, sum) / length : 0;  // opposite l and v have no half vector
    return std::pow(std::max(cosine, 0.0), shininess);
}

double attenuation(const dvec3& coefficients, double d) {
    return 1 / (coefficients.x + coefficients.y * d + coefficients.z * d * d);
}

double spot_factor(double cos_angle, double inner_degrees, double outer_degrees) {
    const double cos_inner = std::cos(glm::radians(inner_degrees));
    const double cos_outer = std::cos(glm::radians(outer_degrees));
    const double scale = 1 / std::max(0.001, cos_inner - cos_outer);
    const double ramp = std::clamp((cos_angle - cos_outer) * scale, 0.0, 1.0);
    return ramp * ramp;
}

}  // namespace raymill::reference
