#include "verify/light_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/formulas.hpp"
#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

double largest(const dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// lib/math.h states 2e-7 for the cosine and sine of a turn; with the roundings around it a point on a circle errs by
// this.
constexpr double circle_error = 6e-7;

/// How far the sample's point on the light may be off, and what else the kernel's roundings do to the sample.
struct OwnError {
    double point = 0;
    double direction = 0;
    double distance = 0;
    dvec3 incoming{0};
};

OwnError own_error(const PointLight& light, const reference::LightSample&) {
    return {light.radius * circle_error + (light.radius > 0 ? 3 * rounding * largest(light.position) : 0), 0, 0, {}};
}

OwnError own_error(const SpotLight& light, const reference::LightSample& s) {
    // The cone's ramp is scale * cosine + offset: both constants are rounded, and their sum; the cosine has nine more.
    const double cos_inner = std::cos(glm::radians(double{light.inner_angle}));
    const double cos_outer = std::cos(glm::radians(double{light.outer_angle}));
    const double ramp = 12 * rounding / std::max(0.001, cos_inner - cos_outer);
    const dvec3 full = dvec3(light.intensity) * reference::attenuation(light.attenuation, s.distance);
    return {0, 0, 0, full * (2 * ramp + ramp * ramp)};
}

OwnError own_error(const DirectionalLight&, const reference::LightSample&) {
    return {0, 3 * rounding, 0, {}};
}

/// The cosine at the light has an absolute error of nine roundings: direction five, inner product three, normal one.
dvec3 form_error(const dvec3& radiance, double area, double distance) {
    return radiance * (9 * rounding * area / (glm::pi<double>() * distance * distance));
}

OwnError own_error(const RectangleLight& light, const reference::LightSample& s) {
    const dvec3 u = light.edge_u, v = light.edge_v;
    const double point = 3 * rounding * (largest(light.center) + largest(u) + largest(v));
    return {point, 0, 0, form_error(light.radiance, glm::length(glm::cross(u, v)), s.distance)};
}

OwnError own_error(const DiskLight& light, const reference::LightSample& s) {
    const double radius = light.radius;
    const double point = 3 * rounding * largest(light.center) + circle_error * radius;
    return {point, 0, 0, form_error(light.radiance, glm::pi<double>() * radius * radius, s.distance)};
}

OwnError own_error(const SphereLight& light, const reference::LightSample& s) {
    if (s.incoming == dvec3(0)) return {};
    // Near the limb the half chord is the root of a difference: half of its square root is lost at worst.
    const double radius = light.radius;
    return {circle_error * radius, 8 * rounding, radius * std::sqrt(16 * rounding), {}};
}

OwnError own_error(const AmbientLight&, const reference::LightSample&) {
    return {};
}
OwnError own_error(const EnvironmentLight&, const reference::LightSample&) {
    return {};
}

/// max(x, 0)^exponent with 0^0 = 1, as lib/math.h has it.
double power(double x, double exponent) {
    return exponent == 0 ? 1 : std::pow(std::max(x, 0.0), exponent);
}

/// Everything that the terms at one point depend on.
struct Point {
    dvec3 n, l, v;
    double n_error, l_error;
    dvec3 incoming, incoming_error;
};

/// n·l and the highlight's factor, each with its error.
struct Factors {
    double cosine = 0, cosine_error = 0;
    double highlight = 0, highlight_error = 0;
};

Factors factors_at(const SceneMaterial& material, const Point& p) {
    const double cosine = glm::dot(p.n, p.l), cosine_error = p.n_error + p.l_error + 4 * rounding;
    Factors f;
    if (cosine < -cosine_error) return f;
    double h = 0, h_error = 0;
    if (material.highlight == Highlight::phong) {
        h = glm::dot(p.v, 2 * cosine * p.n - p.l);
        h_error = 4 * p.n_error + 3 * p.l_error + 16 * rounding;
    } else {
        const dvec3 sum = p.l + p.v;
        const double length = std::max(glm::length(sum), 1e-300);
        h = glm::dot(p.n, sum) / length;
        h_error = p.n_error + 2 * (p.l_error + 7 * rounding) / length + 6 * rounding;
    }
    const double alpha = material.shininess;
    const double low = power(h - h_error, alpha), middle = power(h, alpha), high = power(h + h_error, alpha);
    // power() is within (4 + 4 |alpha log2 h|) roundings of its own argument.
    const double digits = h + h_error > 0 ? 4 + 4 * alpha * std::abs(std::log2(h + h_error)) : 0;
    f.cosine = std::max(cosine, 0.0);
    f.cosine_error = cosine_error;
    f.highlight = cosine > 0 ? middle : 0;
    f.highlight_error = std::max(high - middle, middle - low) + rounding * digits * high + underflow;
    if (cosine <= cosine_error) f.highlight_error += high;  // the guard n·l > 0 may go either way
    return f;
}

TermBounds terms_at(const SceneMaterial& material, const Bounded& diffuse, const Point& p) {
    const Factors f = factors_at(material, p);
    const Bounded incoming{p.incoming, p.incoming_error};
    TermBounds b;
    b.diffuse = (diffuse * incoming * Bounded{dvec3(f.cosine), dvec3(f.cosine_error)}).error;
    b.specular = (exact(material.specular) * incoming * Bounded{dvec3(f.highlight), dvec3(f.highlight_error)}).error;
    return b;
}

/// The light sample as a vertex sees it: what lib/shading.h evaluates there.
Point at_vertex(const Scene& scene, const reference::Tracer& tracer, const reference::Surface& surface,
                const dvec3& vertex, const LightChoice& choice, const LightBounds& light) {
    const SceneLight& source = scene.lights[choice.light];
    Point p{};
    const bool seen_anew =
        std::holds_alternative<PointLight>(source.light) || std::holds_alternative<SpotLight>(source.light);
    if (seen_anew) {
        const LightBounds there = light_bounds(scene, tracer, choice, vertex, 0);
        p.l = there.sample.direction;
        p.l_error = there.direction;
        p.incoming = there.sample.incoming;
        p.incoming_error = there.incoming;
        return p;
    }
    p.incoming = light.sample.incoming;
    p.incoming_error = light.incoming;
    p.l = light.sample.direction;
    p.l_error = light.direction;
    if (std::holds_alternative<DirectionalLight>(source.light)) return p;
    const dvec3 to_light = surface.position + light.sample.distance * light.sample.direction - vertex;
    const double distance = std::max(glm::length(to_light), 1e-300);
    p.l = to_light / distance;
    p.l_error = (light.distance + light.direction * light.sample.distance) / distance + 8 * rounding;
    return p;
}

}  // namespace

LightBounds light_bounds(const Scene& scene, const reference::Tracer& tracer, const LightChoice& choice, const dvec3& p,
                         double position) {
    const auto seen_from = [&](const dvec3& from) {
        return tracer.sample_light(choice.light, choice.light_sample, from, choice.sample, choice.path);
    };
    const SceneLight& source = scene.lights[choice.light];
    LightBounds b;
    b.sample = seen_from(p);
    const OwnError own = std::visit([&](const auto& light) { return own_error(light, b.sample); }, source.light);
    b.direction = own.direction + 5 * rounding;
    b.distance = own.distance;
    b.incoming = own.incoming / static_cast<double>(source.samples) + 12 * rounding * b.sample.incoming;
    if (!(b.sample.distance < INFINITY)) return b;
    // The vector to the light is rounded once; a sphere light's root of 1 - r^2/d^2 has six roundings of d.
    const double reach = std::holds_alternative<SphereLight>(source.light) ? 6 : 2;
    const double step = position + own.point + reach * rounding * b.sample.distance;
    b.distance += 4 * rounding * b.sample.distance;
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 shift(0);
        shift[axis] = step;
        double direction = 0, distance = 0;
        dvec3 incoming(0);
        for (const dvec3& from : {p - shift, p + shift}) {
            const reference::LightSample s = seen_from(from);
            direction = std::max(direction, glm::length(s.direction - b.sample.direction));
            distance = std::max(distance, std::abs(s.distance - b.sample.distance));
            incoming = glm::max(incoming, glm::abs(s.incoming - b.sample.incoming));
        }
        b.direction += direction;
        b.distance += distance;
        b.incoming += incoming;
    }
    return b;
}

Bounded diffuse_color(const reference::Tracer& tracer, const reference::Surface& surface, const SurfaceBounds& bounds) {
    Bounded color{tracer.diffuse_color(surface), dvec3(0)};
    const auto spread = [&](reference::Surface moved) { return glm::abs(tracer.diffuse_color(moved) - color.value); };
    for (int axis = 0; axis < 3; ++axis) {
        reference::Surface low = surface, high = surface;
        low.position[axis] -= bounds.position;
        high.position[axis] += bounds.position;
        color.error += glm::max(spread(low), spread(high));
    }
    for (int axis = 0; axis < 2; ++axis) {
        reference::Surface low = surface, high = surface;
        // Wrapping into [0, 1) and scaling to texels rounds at most three times what is 1 at most.
        const double step = bounds.uv + 3 * rounding;
        low.uv[axis] -= step;
        high.uv[axis] += step;
        color.error += glm::max(spread(low), spread(high));
    }
    color.error += 8 * rounding * glm::abs(color.value);  // two linear interpolations and the product
    return color;
}

TermBounds term_bounds(const Scene& scene, const reference::Tracer& tracer, const reference::Ray& ray,
                       const reference::Hit& hit, const reference::Surface& surface, const SurfaceBounds& bounds,
                       const Bounded& diffuse, const LightChoice& choice, const LightBounds& light) {
    const SceneMaterial& material = scene.materials[surface.material];
    const double side = surface.inside ? -1 : 1;
    if (material.shading != Shading::gouraud || !is_triangle(scene, hit.primitive)) {
        const Point p{side * surface.shading_normal,
                      light.sample.direction,
                      -glm::normalize(ray.direction),
                      bounds.shading_normal,
                      light.direction,
                      light.sample.incoming,
                      light.incoming};
        return terms_at(material, diffuse, p);
    }
    const double weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    const Triangle& triangle = scene.triangles[hit.primitive];
    bool smooth = true;
    for (const uint index : triangle.vertex) smooth &= reference::to_dvec3(scene.vertices[index].normal) != dvec3(0);
    TermBounds sum;
    for (int k = 0; k < 3; ++k) {
        const Vertex& vertex = scene.vertices[triangle.vertex[k]];
        const dvec3 position = reference::to_dvec3(vertex.position), normal = reference::to_dvec3(vertex.normal);
        Point p = at_vertex(scene, tracer, surface, position, choice, light);
        p.n = side * (smooth ? glm::normalize(normal) : surface.geometric_normal);
        p.n_error = smooth ? 5 * rounding : bounds.geometric_normal;
        const double to_eye = glm::length(ray.origin - position);
        p.v = to_eye > 0 ? (ray.origin - position) / to_eye : -glm::normalize(ray.direction);
        const TermBounds at = terms_at(material, diffuse, p);
        // The weights err by three roundings, which count against the whole term.
        const Factors f = factors_at(material, p);
        sum.diffuse += std::abs(weights[k]) * at.diffuse +
                       6 * rounding * glm::abs(diffuse.value) * glm::abs(p.incoming) * f.cosine;
        sum.specular += std::abs(weights[k]) * at.specular +
                        6 * rounding * dvec3(material.specular) * glm::abs(p.incoming) * f.highlight;
    }
    return sum;
}

}  // namespace raymill::verify
