#include "verify/split_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reference/formulas.hpp"

namespace raymill::verify {

namespace {

/// A refraction about one normal whose error is known.
struct Interface {
    dvec3 d, n;
    double n_error;
    double eta;
};

// The root of 1 - sin^2 is taken of a number that carries seven roundings: so many in eta cover it.
constexpr double eta_spread = 7 * rounding;

/// Signed distance of sin^2 from 1 over its bound: positive where the ray passes.
double passing_margin(const Interface& i) {
    const dvec3 tangential = (i.d - glm::dot(i.d, i.n) * i.n) / i.eta;
    const double sin2 = glm::dot(tangential, tangential);
    const double tangential_error = (2 * i.n_error + 7 * rounding) / i.eta;
    return (1 - sin2) / (2 * std::sqrt(sin2) * tangential_error + 8 * rounding * sin2 + rounding);
}

double refracted_error(const Interface& i, const dvec3& refracted) {
    const auto distance = [&](const dvec3& n, double eta) {
        const std::optional<dvec3> moved = reference::refract(i.d, n, eta);
        return moved ? glm::length(*moved - refracted) : 0.0;
    };
    double error = 9 * rounding;
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 shift(0);
        shift[axis] = i.n_error + 5 * rounding;
        error += std::max(distance(i.n - shift, i.eta), distance(i.n + shift, i.eta));
    }
    if (i.eta != 1) error += std::max(distance(i.n, i.eta * (1 - eta_spread)), distance(i.n, i.eta * (1 + eta_spread)));
    return error;
}

/// Of the reflectance.
double fresnel_error(const Interface& i) {
    const double cosine = std::clamp(-glm::dot(i.d, i.n), 0.0, 1.0);
    const double step = i.n_error + 7 * rounding;
    const double middle = reference::fresnel(cosine, i.eta);
    double error = 12 * rounding;
    for (const double c : {cosine - step, cosine + step})
        for (const double eta : {i.eta * (1 - eta_spread), i.eta, i.eta * (1 + eta_spread)})
            error =
                std::max(error, std::abs(reference::fresnel(std::clamp(c, 0.0, 1.0), i.eta == 1 ? 1 : eta) - middle));
    return error + 12 * rounding;
}

}  // namespace

double index_ratio(const SceneMaterial& material, bool inside) {
    const double inward = static_cast<double>(material.ior) / material.exterior_ior;
    return inside ? 1 / inward : inward;
}

SplitBounds split_bounds(const Scene& scene, const reference::Ray& ray, const reference::Surface& surface,
                         const SurfaceBounds& bounds) {
    const SceneMaterial& material = scene.materials[surface.material];
    const double side = surface.inside ? -1 : 1;
    const dvec3 d = glm::normalize(ray.direction);
    const dvec3 geometric = side * surface.geometric_normal, shading = side * surface.shading_normal;
    SplitBounds b;
    b.reflection = b.transmission = 3 * rounding;
    const auto consider = [&](double margin) { b.margin = std::min(b.margin, std::abs(margin)); };
    consider(bounds.facing);

    if (material.transmission > 0 || material.fresnel) {
        Interface face{d, shading, bounds.shading_normal, index_ratio(material, surface.inside)};
        std::optional<dvec3> refracted = reference::refract(d, shading, face.eta);
        if (face.eta != 1) consider(passing_margin(face));
        if (refracted) {
            const double toward = glm::dot(*refracted, geometric);
            consider(toward / (refracted_error(face, *refracted) + bounds.geometric_normal + 4 * rounding));
            if (toward >= 0) {
                face.n = geometric;
                face.n_error = bounds.geometric_normal;
                refracted = reference::refract(d, geometric, face.eta);
                if (face.eta != 1) consider(passing_margin(face));
            }
        }
        if (refracted) b.refracted = refracted_error(face, *refracted);
        if (material.fresnel) b.reflection = b.transmission = fresnel_error(face) + 4 * rounding;
    }
    const double smooth_error = 4 * bounds.shading_normal + 11 * rounding;
    const double away = glm::dot(reference::reflect(d, shading), geometric);
    consider(away / (smooth_error + bounds.geometric_normal));
    b.reflected = away > 0 ? smooth_error : 4 * bounds.geometric_normal + 11 * rounding;
    return b;
}

}  // namespace raymill::verify
