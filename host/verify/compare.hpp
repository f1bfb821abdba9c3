// One comparison a stage: an item that a kernel wrote, beside what the reference makes of the same input.
#pragma once

#include <optional>
#include <string>

#include "reference/reference.hpp"
#include "verify/report.hpp"
#include "verify/surface_bounds.hpp"
#include "verify/wave_recorder.hpp"

namespace raymill::verify {

/// What all comparisons share. const: threads may share it. The references must outlive it.
struct Truth {
    const Scene& scene;
    const reference::Tracer& tracer;
};

/// A hit as both sides are given it, with everything that its light samples and children share.
struct HitContext {
    reference::Ray ray;
    reference::Hit hit;
    reference::Surface surface;
    SurfaceBounds bounds;
    Bounded throughput;  // at the hit, absorption included
    Bounded local;       // share of local illumination
};
HitContext hit_context(const Truth& truth, const Ray& ray, const Hit& hit);

/// A camera ray against the camera, the pixel and the sample that it names.
Comparison compare_camera_ray(const Truth& truth, const Ray& ray);

/// The closest hit of a ray, and what a miss adds.
Comparison compare_hit(const Truth& truth, const Ray& ray, const Hit& hit, const Contribution& added);

/// Ambient and emission of a hit, and its coverage.
Comparison compare_unshadowed(const Truth& truth, const HitContext& context, const Ray& ray, const Contribution& added);

/// The shadow ray of a hit to a light sample, or its absence.
Comparison compare_shadow_ray(const Truth& truth, const HitContext& context, const Ray& ray, const LightSlot& slot,
                              const ShadowRay* shadow_ray);

/// What a shadow ray adds to the film.
Comparison compare_arrival(const Truth& truth, const ShadowItem& item);

/// The reflected (branch 0) or refracted (1) child of a hit, or its absence.
Comparison compare_child(const Truth& truth, const HitContext& context, const Ray& parent, uint branch,
                         const Ray* child);

/// Adds the fields of a ray's start that leaves the surface on the side that the ray came from (side 1) or the other
/// (-1).
void compare_start(Comparison& comparison, const Truth& truth, const HitContext& context, const float (&origin)[3],
                   double side);

/// Film units as a number.
inline double from_units(std::int64_t units) {
    return static_cast<double>(units) * 0x1p-32;
}

/// All fields of a queue item, one a line.
std::string describe(const Ray& ray);
std::string describe(const Hit& hit);
std::string describe(const ShadowRay& ray);

}  // namespace raymill::verify
