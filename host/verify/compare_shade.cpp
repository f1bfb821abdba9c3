// The shade stage: ambient, emission and coverage, and the shadow ray of each light sample.
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

/// Where a shadow ray starts and goes, with bounds of each coordinate, of the direction's length, and of the distance.
struct Aim {
    dvec3 origin, direction;
    double distance;
    double origin_error, direction_error, distance_error;
    bool lifted;
};

Aim aim_of(const Truth& truth, const HitContext& context, const LightBounds& light) {
    const SurfaceBounds& bounds = context.bounds;
    const bool robust = truth.scene.settings.shadow_offset == ShadowOffset::robust;
    Aim aim{context.surface.position,
            light.sample.direction,
            light.sample.distance,
            robust ? bounds.offset : 2 * bounds.position,
            light.direction,
            light.distance,
            false};
    if (!robust || !context.surface.smooth) return aim;
    // From the curved surface, towards the same point of the light.
    const reference::Ray ray = truth.tracer.shadow_ray(context.ray, context.hit, context.surface, light.sample);
    aim.lifted = true;
    aim.origin = ray.origin;
    // The lift is a mean of heights over the vertices' tangent planes: what the position errs by, and ten roundings of
    // the triangle's size.
    double size = 0;
    const Triangle& triangle = truth.scene.triangles[context.hit.primitive];
    for (const uint vertex : triangle.vertex)
        size = std::max(
            size, glm::length(reference::to_dvec3(truth.scene.vertices[vertex].position) - context.surface.position));
    aim.origin_error += diagonal * bounds.position + 10 * rounding * size;
    if (!(light.sample.distance < INFINITY)) return aim;
    const double stretch = std::max(glm::length(ray.direction), 1e-300);
    aim.direction = ray.direction / stretch;
    aim.distance = stretch * light.sample.distance;
    // The kernel aims from where the ray starts, off the surface; the reference from the surface itself.
    const double moved = diagonal * aim.origin_error;
    aim.direction_error =
        (light.direction * light.sample.distance + light.distance + moved) / aim.distance + 5 * rounding;
    aim.distance_error = light.distance + light.direction * light.sample.distance + moved + 4 * rounding * aim.distance;
    return aim;
}

/// Beer-Lambert along the segment that ended here.
Bounded absorption_of(const SceneMaterial& material, const reference::Ray& ray, const reference::Hit& hit,
                      bool inside) {
    if (!inside || material.absorption == glm::vec3(0)) return exact(dvec3(1));
    const dvec3 depth = hit.t * glm::length(ray.direction) * dvec3(material.absorption);
    const dvec3 left = glm::exp(-depth);
    // The exponent has four roundings and the direction's length five more; lib/math.h: the power itself four.
    return {left, left * (9 * rounding * depth + 6 * rounding) + underflow};
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

Comparison compare_unshadowed(const Truth& truth, const HitContext& context, const Ray& ray,
                              const Contribution& added) {
    const Bounded ambient{truth.tracer.ambient_term(context.surface),
                          8 * rounding * truth.tracer.ambient_term(context.surface)};
    const Bounded emission = exact(truth.tracer.emission(context.surface));
    Comparison c;
    compare_units(c, "ambient", added.ambient, context.throughput * ambient * context.local);
    compare_units(c, "emission", added.emission, context.throughput * emission);
    const double coverage = from_units(added.coverage), covered = ray.route == ROUTE_CAMERA ? 1 : 0;
    c.number("coverage", coverage, covered, 0);
    if (!(c.ratio() <= 1) && context.bounds.facing < 1 && coverage == covered)
        c.disagree("the ray grazes the surface", context.bounds.facing);
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
    // A smooth surface is guarded by its shading normal alone.
    const double undecided =
        context.surface.smooth ? context.bounds.facing : std::min(height_margin, context.bounds.facing);

    Comparison c;
    if (!shadow_ray) {
        // What is nothing within its bound needs no ray.
        const float nothing[3] = {0, 0, 0};
        c.vector("diffuse", nothing, diffuse.value, diffuse.error + underflow);
        c.vector("specular", nothing, specular.value, specular.error + underflow);
        if (!(c.ratio() <= 1)) c.disagree("the kernel sends no shadow ray where the reference does", undecided);
        return c;
    }
    const Aim aim = aim_of(truth, context, light);
    if (aim.lifted)
        c.vector("origin", shadow_ray->origin, aim.origin, dvec3(aim.origin_error));
    else
        compare_start(c, truth, context, shadow_ray->origin, 1);
    c.vector("direction", shadow_ray->direction, aim.direction, dvec3(aim.direction_error));
    const bool endless = !(light.sample.distance < INFINITY);
    const double reach = endless ? 1 : light.sample.shadow_distance / light.sample.distance;
    c.number("t_max", shadow_ray->t_max, aim.distance * reach, aim.distance_error + 4 * rounding * aim.distance);
    c.vector("diffuse", shadow_ray->diffuse, diffuse.value, diffuse.error);
    c.vector("specular", shadow_ray->specular, specular.value, specular.error);
    c.same("pixel", shadow_ray->pixel, ray.pixel);
    c.same("route", shadow_ray->route, ray.route);
    c.same("light", shadow_ray->light, slot.light);
    if (!(c.ratio() <= 1) && undecided < 1) c.disagree("the light or the ray grazes the surface", undecided);
    return c;
}

}  // namespace raymill::verify
