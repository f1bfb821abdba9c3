// The formulas of the reference: pure functions of numbers in double precision, each with its source.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

namespace raymill::reference {

using glm::dvec2;
using glm::dvec3;

/// Two unit vectors that complete a unit normal to a right-handed orthonormal frame (t, u, n).
struct Tangents {
    dvec3 t;
    dvec3 u;
};

/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017, listing 3.
Tangents tangents(const dvec3& n);

/// Maps the unit square to the unit disk, area-preserving; the square's centre goes to the origin.
/// Source: Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997.
dvec2 concentric_disk(const dvec2& square);

/// Point `index` of the stratified points of the unit square [0, 1)^2, of the family `key` (lib/random.h).
dvec2 stratified_square(std::uint32_t index, std::uint32_t key);

/// A point of the unit sphere, uniform for a uniform point (a, b) of the square: z = 1 - 2a, azimuth 2 pi b from +x.
dvec3 uniform_sphere(const dvec2& square);

/// Direction i mirrored about n, both unit; i points to the surface, the result away from it.
dvec3 reflect(const dvec3& i, const dvec3& n);

/// Direction i refracted at the unit normal n on i's side (i·n <= 0); eta = n_transmitted / n_incident > 0.
/// Nothing past the critical angle. Source: Snell's law in vectors, Pharr, Jakob, Humphreys, PBR 4e, section 9.3.
std::optional<dvec3> refract(const dvec3& i, const dvec3& n, double eta);

/// Unpolarised Fresnel reflectance of a dielectric in [0, 1]; 1 under total internal reflection.
/// cos_i in [0, 1]; eta as above. Source: Pharr, Jakob, Humphreys, PBR 4e, section 9.3.
double fresnel(double cos_i, double eta);

/// max(v·r, 0)^shininess with r the mirror of l about n; 0^0 is 1. All unit and pointing away from the surface.
/// Source: Phong, "Illumination for Computer Generated Pictures", CACM 18(6), 1975.
double phong_highlight(const dvec3& n, const dvec3& l, const dvec3& v, double shininess);

/// max(n·h, 0)^shininess with h halfway between l and v.
/// Source: Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977.
double blinn_highlight(const dvec3& n, const dvec3& l, const dvec3& v, double shininess);

/// 1 / (c0 + c1 d + c2 d^2), coefficients = (c0, c1, c2).
double attenuation(const dvec3& coefficients, double d);

/// Cone factor in [0, 1] at an angle with cosine cos_angle to the spot's axis; half angles in degrees.
/// Source: glTF extension KHR_lights_punctual, "Inner and Outer Cone Angles".
double spot_factor(double cos_angle, double inner_degrees, double outer_degrees);

}  // namespace raymill::reference
