#include "verify/explanation.hpp"

#include <algorithm>
#include <cmath>

#include "reference/formulas.hpp"
#include "verify/scene_parts.hpp"
#include "verify/split_bounds.hpp"

namespace raymill::verify {

namespace {

double attenuation_of(const SceneLight& light, double distance) {
    if (const auto* point = std::get_if<PointLight>(&light.light))
        return reference::attenuation(point->attenuation, distance);
    if (const auto* spot = std::get_if<SpotLight>(&light.light))
        return reference::attenuation(spot->attenuation, distance);
    return 1;
}

}  // namespace

Passage passage_of(const Truth& truth, const ShadowRay& ray) {
    const reference::Ray r = reference_ray(ray);
    Passage passage;
    if (truth.scene.settings.shadows == ShadowMode::none) return passage;
    for (double t = 0;;) {
        const reference::Hit hit = truth.tracer.intersect(r, t);
        if (hit.primitive == NO_INDEX || hit.t >= ray.t_max) return passage;
        if (shadow_filter(truth.scene, hit.primitive) == dvec3(0)) {
            passage.blocker = Obstacle{hit.primitive, hit.t};
            return passage;
        }
        passage.filters.push_back({hit.primitive, hit.t});
        t = hit.t;
    }
}

Snell snell_at(const Truth& truth, const HitContext& context) {
    const SceneMaterial& material = truth.scene.materials[context.surface.material];
    const dvec3 d = glm::normalize(context.ray.direction);
    const dvec3 n = context.surface.inside ? -context.surface.shading_normal : context.surface.shading_normal;
    Snell s;
    s.n1 = context.surface.inside ? material.ior : material.exterior_ior;
    s.n2 = context.surface.inside ? material.exterior_ior : material.ior;
    const auto angle = [&](double cosine) { return glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))); };
    s.incident = angle(-glm::dot(d, n));
    if (const auto refracted = reference::refract(d, n, index_ratio(material, context.surface.inside)))
        s.refracted = angle(-glm::dot(*refracted, n));
    if (s.n2 < s.n1) s.critical = glm::degrees(std::asin(s.n2 / s.n1));
    return s;
}

LightTerms light_terms(const Truth& truth, const HitContext& context, const Ray& ray, const LightSlot& slot) {
    const reference::Surface& surface = context.surface;
    const SceneMaterial& material = truth.scene.materials[surface.material];
    const double side = surface.inside ? -1 : 1;
    const dvec3 n = side * surface.shading_normal, v = -glm::normalize(context.ray.direction);
    LightTerms terms;
    terms.sample = truth.tracer.sample_light(slot.light, slot.sample, surface.position, ray.sample, ray.path);
    const dvec3 l = terms.sample.direction;
    terms.attenuation = attenuation_of(truth.scene.lights[slot.light], terms.sample.distance);
    terms.n_dot_l = glm::dot(n, l);
    terms.geometric_n_dot_l = side * glm::dot(surface.geometric_normal, l);
    const auto highlight =
        material.highlight == Highlight::phong ? reference::phong_highlight : reference::blinn_highlight;
    terms.highlight = highlight(n, l, v, 1);
    const reference::LocalTerms local =
        truth.tracer.local_terms(context.ray, context.hit, surface, slot.light, slot.sample, ray.sample, ray.path);
    terms.diffuse = local.diffuse;
    terms.specular = local.specular;
    return terms;
}

}  // namespace raymill::verify
