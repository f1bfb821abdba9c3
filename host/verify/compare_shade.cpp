// The shade stage: ambient and emission, and the shadow ray of each light sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "verify/compare.hpp"
#include "verify/light_bounds.hpp"
#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

void compare_units(Comparison& c, const char* name, const Units& units, const Bounded& expected) {
    for (int k = 0; k < 3; ++k)
        c.number(fmt::format("{}[{}]", name, k), from_units(units[k]),
                 std::clamp(expected.value[k], -double{FILM_LIMIT}, double{FILM_LIMIT}),
                 expected.error[k] + film_rounding);
}

/// Beer-Lambert along the segment that ended here.
Bounded absorption_of(const SceneMaterial& material, const reference::Ray& ray, const reference::Hit& hit,
                      bool inside) {
    if (!inside || material.absorption == glm::vec3(0)) return exact(dvec3(1));
    const dvec3 depth = hit.t * glm::length(ray.direction) * dvec3(material.absorption);
    const dvec3 left = glm::exp(-depth);
    // The exponent has four roundings and the direction's length four more; lib/math.h: the power itself four.
    return {left, left * (8 * rounding * depth + 6 * rounding) + underflow};
}

}  // namespace

HitContext hit_context(const Truth& truth, const Ray& ray, const Hit& hit) {
    HitContext c{reference_ray(ray), reference_hit(hit), {}, {}, {}, {}};
    c.surface = truth.tracer.surface(c.ray, c.hit);
    c.bounds = surface_bounds(truth.scene, c.ray, c.hit, c.surface);
    const SceneMaterial& material = truth.scene.materials[c.surface.material];
    c.throughput = exact(reference::to_dvec3(ray.throughput)) * absorption_of(material, c.ray, c.hit, c.surface.inside);
    // 1 - reflection - transmission is rounded twice; where it should be zero, one of the two sides may not be.
    const double local = std::max(0.0, 1 - double{material.reflection} - double{material.transmission});
    c.local = {dvec3(local), dvec3(material.reflection + material.transmission > 0 ? 2 * rounding : 0)};
    return c;
}

void compare_start(Comparison& comparison, const Truth& truth, const HitContext& context, const float (&origin)[3],
                   double side) {
    const SurfaceBounds& bounds = context.bounds;
    const bool robust = truth.scene.settings.shadow_offset == ShadowOffset::robust;
    comparison.vector("origin", origin, context.surface.position, dvec3(robust ? bounds.offset : 2 * bounds.position));
    // A normal without a direction, of a triangle seen as a line, tells no sides.
    if (!robust || bounds.geometric_normal > 0.01 || bounds.facing < 1) return;
    const double outward = context.surface.inside ? -side : side;
    const double height = outward * height_above(truth.scene, context.hit.primitive, reference::to_dvec3(origin));
    comparison.same("starts on the right side", height > 0, true);
}

Comparison compare_unshadowed(const Truth& truth, const HitContext& context, const Contribution& added) {
    const Bounded ambient{truth.tracer.ambient_term(context.surface),
                          8 * rounding * truth.tracer.ambient_term(context.surface)};
    const Bounded emission = exact(truth.tracer.emission(context.surface));
    Comparison c;
    compare_units(c, "ambient", added.ambient, context.throughput * ambient * context.local);
    compare_units(c, "emission", added.emission, context.throughput * emission);
    if (!(c.ratio() <= 1) && context.bounds.facing < 1) c.disagree("the ray grazes the surface", context.bounds.facing);
    return c;
}

Comparison compare_shadow_ray(const Truth& truth, const HitContext& context, const Ray& ray, const LightSlot& slot,
                              const ShadowRay* shadow_ray) {
    const LightChoice choice{slot.light, slot.sample, ray.sample, ray.path};
    const LightBounds light =
        light_bounds(truth.scene, truth.tracer, choice, context.surface.position, context.bounds.position);
    const reference::LocalTerms terms = truth.tracer.local_terms(context.ray, context.hit, context.surface, slot.light,
                                                                 slot.sample, ray.sample, ray.path);
    const Bounded color = diffuse_color(truth.tracer, context.surface, context.bounds);
    const TermBounds errors = term_bounds(truth.scene, truth.tracer, context.ray, context.hit, context.surface,
                                          context.bounds, color, choice, light);
    const Bounded weight = context.throughput * context.local;
    const Bounded diffuse = weight * Bounded{terms.diffuse, errors.diffuse};
    const Bounded specular = weight * Bounded{terms.specular, errors.specular};

    // How clearly the light stands above the geometric surface.
    const double height =
        glm::dot(light.sample.direction, context.surface.geometric_normal) * (context.surface.inside ? -1 : 1);
    const double height_margin = std::abs(height) / (context.bounds.geometric_normal + light.direction + 4 * rounding);
    const double undecided = std::min(height_margin, context.bounds.facing);

    Comparison c;
    if (!shadow_ray) {
        // What is nothing within its bound needs no ray.
        const float nothing[3] = {0, 0, 0};
        c.vector("diffuse", nothing, diffuse.value, diffuse.error + underflow);
        c.vector("specular", nothing, specular.value, specular.error + underflow);
        if (!(c.ratio() <= 1)) c.disagree("the kernel sends no shadow ray where the reference does", undecided);
        return c;
    }
    compare_start(c, truth, context, shadow_ray->origin, 1);
    c.vector("direction", shadow_ray->direction, light.sample.direction, dvec3(light.direction));
    c.number("t_max", shadow_ray->t_max, light.sample.shadow_distance,
             light.distance + 4 * rounding * light.sample.distance);
    c.vector("diffuse", shadow_ray->diffuse, diffuse.value, diffuse.error);
    c.vector("specular", shadow_ray->specular, specular.value, specular.error);
    c.same("pixel", shadow_ray->pixel, ray.pixel);
    c.same("route", shadow_ray->route, ray.route);
    c.same("light", shadow_ray->light, slot.light);
    if (!(c.ratio() <= 1) && undecided < 1) c.disagree("the light or the ray grazes the surface", undecided);
    return c;
}

}  // namespace raymill::verify
