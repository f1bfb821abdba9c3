// The secondary stage: reflected and refracted rays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/random.h"
#include "verify/compare.hpp"
#include "verify/split_bounds.hpp"

namespace raymill::verify {

namespace {

/// One of the two branches as the reference has it.
struct Branch {
    double share, share_error;
    dvec3 direction;
    double direction_error;
};

Branch branch_of(const Truth& truth, const HitContext& context, const SplitBounds& bounds, uint branch) {
    const reference::Split split = truth.tracer.split(context.ray, context.surface);
    if (branch == 0) return {split.reflection, bounds.reflection, split.reflected, bounds.reflected};
    return {split.transmission, bounds.transmission, split.refracted, bounds.refracted};
}

double strongest(const dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

}  // namespace

Comparison compare_child(const Truth& truth, const HitContext& context, const Ray& parent, uint branch,
                         const Ray* child) {
    const SceneMaterial& material = truth.scene.materials[context.surface.material];
    const SplitBounds bounds = split_bounds(truth.scene, context.ray, context.surface, context.bounds);
    const Branch expected = branch_of(truth, context, bounds, branch);
    const Bounded weight =
        context.throughput * exact(material.base_color) * Bounded{dvec3(expected.share), dvec3(expected.share_error)};
    const double least = truth.scene.settings.min_weight, strength = strongest(weight.value);
    // A share of zero that does not follow from the branch alone (a Fresnel reflectance) may be rounded from or to it.
    const double strength_error = strongest(weight.error) + underflow;
    double margin = bounds.margin;
    if (expected.share > 0 || material.fresnel) margin = std::min(margin, std::abs(strength - least) / strength_error);
    const bool exists = strength > 0 && strength >= least;

    Comparison c;
    if (exists != (child != nullptr)) {
        c.disagree(fmt::format("the {} ray is {}", branch == 0 ? "reflected" : "refracted",
                               exists ? "missing" : "one that the reference does not send"),
                   margin);
        return c;
    }
    if (!child) return c;
    compare_start(c, truth, context, child->origin, branch == 0 ? 1 : -1);
    c.vector("direction", child->direction, expected.direction, dvec3(expected.direction_error));
    c.vector("throughput", child->throughput, weight.value, weight.error);
    c.same("pixel", child->pixel, parent.pixel);
    c.same("sample", child->sample, parent.sample);
    c.same("path", child->path, path_child(parent.path, branch));
    const uint first_branch = branch == 0 ? ROUTE_REFLECTED : ROUTE_REFRACTED;
    c.same("route", child->route, parent.route == ROUTE_CAMERA ? first_branch : parent.route);
    if (!(c.ratio() <= 1) && bounds.margin < 1) c.disagree("the hit is on the border to another split", bounds.margin);
    return c;
}

}  // namespace raymill::verify
