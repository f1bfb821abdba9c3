// How far a light sample's terms may be from the reference's where a kernel computes them in single precision.
#pragma once

#include "reference/reference.hpp"
#include "verify/bounded.hpp"
#include "verify/surface_bounds.hpp"

namespace raymill::verify {

/// A light sample and its bounds.
struct LightBounds {
    reference::LightSample sample;
    double direction = 0;  // length of the error
    double distance = 0;
    dvec3 incoming{0};
};

/// Which light sample, on which path.
struct LightChoice {
    std::uint32_t light = 0;
    std::uint32_t light_sample = 0;
    std::uint32_t sample = 0;  // camera sample
    std::uint32_t path = 0;
};

/// Seen from p, of which each coordinate may err by `position`. What moves the point moves the sample: the reference is
/// asked again on six sides of it; the kernel's own roundings are counted on top.
LightBounds light_bounds(const Scene& scene, const reference::Tracer& tracer, const LightChoice& choice, const dvec3& p,
                         double position);

/// Bounds on the diffuse and specular terms of a light sample, colours included, weights not.
struct TermBounds {
    dvec3 diffuse{0};
    dvec3 specular{0};
};

/// k_d and its bound: a texture's and a checker's error is what moves where they are looked up.
Bounded diffuse_color(const reference::Tracer& tracer, const reference::Surface& surface, const SurfaceBounds& bounds);

TermBounds term_bounds(const Scene& scene, const reference::Tracer& tracer, const reference::Ray& ray,
                       const reference::Hit& hit, const reference::Surface& surface, const SurfaceBounds& bounds,
                       const Bounded& diffuse, const LightChoice& choice, const LightBounds& light);

}  // namespace raymill::verify
