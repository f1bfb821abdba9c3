// Local illumination at a hit, and how its energy goes on.
#include <algorithm>
#include <cmath>
#include <optional>

#include "reference/formulas.hpp"
#include "reference/reference.hpp"
#include "reference/textures.hpp"

namespace raymill::reference {

namespace {

/// Diffuse and specular terms with all unit vectors away from the surface; nothing where n·l <= 0.
LocalTerms terms_at(const SceneMaterial& material, const dvec3& diffuse, const dvec3& n, const dvec3& v,
                    const LightSample& light) {
    const double cosine = glm::dot(n, light.direction);
    if (!(cosine > 0)) return {};
    const auto highlight = material.highlight == Highlight::phong ? phong_highlight : blinn_highlight;
    return {diffuse * cosine * light.incoming,
            dvec3(material.specular) * highlight(n, light.direction, v, material.shininess) * light.incoming};
}

/// What the refracted ray would be; no direction under total internal reflection.
struct Refraction {
    std::optional<dvec3> direction;
    double reflectance = 1;  // Fresnel's
};

Refraction refraction_about(const dvec3& d, const dvec3& n, double eta) {
    return {refract(d, n, eta), fresnel(std::clamp(-glm::dot(d, n), 0.0, 1.0), eta)};
}

/// About the shading normal, unless the refracted ray would stay on the incoming side. Both normals face the incoming
/// side of the geometric surface; the shading normal may face away from the ray all the same, which then grazes it.
Refraction refraction(const dvec3& d, const dvec3& shading, const dvec3& geometric, double eta) {
    const Refraction smooth = refraction_about(d, shading, eta);
    if (smooth.direction && glm::dot(*smooth.direction, geometric) >= 0) return refraction_about(d, geometric, eta);
    return smooth;
}

}  // namespace

dvec3 Tracer::background(const dvec3& direction) const {
    dvec3 sum = scene_.settings.background;
    for (const SceneLight& source : scene_.lights) {
        const auto* light = std::get_if<EnvironmentLight>(&source.light);
        if (!light) continue;
        const dvec3 color = light->map ? environment_color(scene_.images[*light->map], direction) : dvec3(1);
        sum += dvec3(light->radiance) * color;
    }
    return sum;
}

dvec3 Tracer::diffuse_color(const Surface& surface) const {
    const SceneMaterial& material = scene_.materials[surface.material];
    const dvec3 color =
        material.diffuse_checker ? checker_color(*material.diffuse_checker, surface.position) : dvec3(material.diffuse);
    return material.diffuse_map ? color * texture_color(scene_.images[*material.diffuse_map], surface.uv) : color;
}

dvec3 Tracer::ambient_term(const Surface& surface) const {
    dvec3 sum(0);
    for (const SceneLight& source : scene_.lights) {
        if (const auto* light = std::get_if<AmbientLight>(&source.light)) sum += dvec3(light->color);
    }
    return dvec3(scene_.materials[surface.material].ambient) * sum;
}

dvec3 Tracer::emission(const Surface& surface) const {
    const SceneMaterial& material = scene_.materials[surface.material];
    return material.one_sided_emission && surface.inside ? dvec3(0) : dvec3(material.emission);
}

LocalTerms Tracer::local_terms(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t light,
                               std::uint32_t light_sample, std::uint32_t sample, std::uint32_t path) const {
    const LightSample at_hit = sample_light(light, light_sample, surface.position, sample, path);
    const double side = surface.inside ? -1 : 1;
    // Below the geometric surface there is no light; of a smooth mesh that surface is the curved one.
    if (!surface.smooth && !(glm::dot(at_hit.direction, side * surface.geometric_normal) > 0)) return {};
    const SceneMaterial& material = scene_.materials[surface.material];
    const bool triangle = hit.primitive < corners_.size();
    if (material.shading == Shading::gouraud && triangle) {
        return gouraud_terms(ray, hit, surface, light, at_hit);
    }
    return terms_at(material, diffuse_color(surface), side * surface.shading_normal, -glm::normalize(ray.direction),
                    at_hit);
}

// Gouraud, "Continuous Shading of Curved Surfaces", IEEE ToC 20(6), 1971. The texture is that of the hit, not of the
// vertices: what is interpolated is the light.
LocalTerms Tracer::gouraud_terms(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t light,
                                 const LightSample& at_hit) const {
    const SceneMaterial& material = scene_.materials[surface.material];
    const dvec3 diffuse = diffuse_color(surface);
    const double side = surface.inside ? -1 : 1;
    const dvec3 weights(1 - hit.u - hit.v, hit.u, hit.v);
    LocalTerms sum;
    for (int k = 0; k < 3; ++k) {
        const Vertex& vertex = scene_.vertices[scene_.triangles[hit.primitive].vertex[k]];
        const dvec3 position = corners_[hit.primitive][k];
        const dvec3 normal =
            side * (is_flat(hit.primitive) ? surface.geometric_normal : glm::normalize(to_dvec3(vertex.normal)));
        const dvec3 to_eye = ray.origin - position;
        const double distance = glm::length(to_eye);
        const dvec3 v = distance > 0 ? to_eye / distance : -glm::normalize(ray.direction);  // an eye on the vertex
        const LocalTerms terms =
            terms_at(material, diffuse, normal, v, light_at_vertex(light, at_hit, surface.position, position));
        sum.diffuse += weights[k] * terms.diffuse;
        sum.specular += weights[k] * terms.specular;
    }
    return sum;
}

Split Tracer::split(const Ray& ray, const Surface& surface) const {
    const SceneMaterial& material = scene_.materials[surface.material];
    Split s;
    s.reflection = material.reflection;
    s.transmission = material.transmission;
    s.local = std::max(0.0, 1 - s.reflection - s.transmission);
    const double total = s.reflection + s.transmission;
    if (total == 0) return s;

    const dvec3 d = glm::normalize(ray.direction);
    const double side = surface.inside ? -1 : 1;
    const dvec3 geometric = side * surface.geometric_normal;
    const dvec3 shading = side * surface.shading_normal;
    if (material.transmission > 0 || material.fresnel) {
        const double inward = static_cast<double>(material.ior) / material.exterior_ior;
        const Refraction refracted = refraction(d, shading, geometric, surface.inside ? 1 / inward : inward);
        if (material.fresnel) s.reflection = total * refracted.reflectance;
        if (!refracted.direction) s.reflection = total;
        s.transmission = total - s.reflection;
        if (refracted.direction) s.refracted = *refracted.direction;
    }
    s.reflected = reflect(d, shading);
    if (glm::dot(s.reflected, geometric) <= 0) s.reflected = reflect(d, geometric);
    return s;
}

}  // namespace raymill::reference
