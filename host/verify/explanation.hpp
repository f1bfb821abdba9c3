// The terms between a ray and what it adds: the reference's view of what the kernels did.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "verify/compare.hpp"
#include "verify/ray_tree.hpp"

namespace raymill::verify {

/// Where something stands in a shadow ray's way.
struct Obstacle {
    std::uint32_t primitive = NO_INDEX;
    double t = 0;
};

/// What a shadow ray met before its light: filters that it passed, and what blocked it if anything did.
struct Passage {
    std::vector<Obstacle> filters;
    std::optional<Obstacle> blocker;
};
Passage passage_of(const Truth& truth, const ShadowRay& ray);

/// Angles to the normal of a ray at an interface, degrees.
struct Snell {
    double n1 = 1, n2 = 1;
    double incident = 0;
    std::optional<double> refracted;  // nothing: total internal reflection
    double critical = 90;             // where total internal reflection begins; 90 if it never does
};
Snell snell_at(const Truth& truth, const HitContext& context);

/// A light sample's lecture terms at a hit.
struct LightTerms {
    reference::LightSample sample;
    double attenuation = 1;
    double n_dot_l = 0;            // on the shading normal
    double geometric_n_dot_l = 0;  // on the geometric one
    double highlight = 0;          // v·r, or n·h with Blinn's highlight
    dvec3 diffuse{0}, specular{0};
};
LightTerms light_terms(const Truth& truth, const HitContext& context, const Ray& ray, const LightSlot& slot);

/// The trees in words and numbers, and the sum beside the film's pixel. sample: only this one's.
/// Lines of about 110 columns; numbers of six significant digits.
std::string explanation_text(const Truth& truth, const RayTree& tree, std::optional<std::uint32_t> sample);

/// All rays as lines of an OBJ file, a comment before each. escape: length of those that hit nothing.
std::string ray_lines(const Truth& truth, const RayTree& tree, std::optional<std::uint32_t> sample, double escape);

}  // namespace raymill::verify
