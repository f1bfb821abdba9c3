// Where a ray meets a triangle, a sphere or a plane, in double precision and without an epsilon.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

namespace raymill::reference {

using glm::dvec3;

/// How rays meet the border of a triangle.
/// closed: the three edges and vertices belong to it.
/// crossing: of the triangles that share an edge or a vertex of one surface exactly one counts, as if the ray were
/// moved
///   by an infinitesimal amount that is the same for all of them; a silhouette counts twice or not at all.
enum class Border { closed, crossing };

struct TriangleHit {
    double t;
    double u;  // weight of vertex 1
    double v;  // weight of vertex 2
};

/// Both ends of a chord, near <= far; either may lie behind the origin.
struct SphereHits {
    double near;
    double far;
};

/// A ray prepared for the watertight triangle test. Distances are in multiples of the direction, which must not be
/// zero. Sources: triangles, Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with a
/// symbolic
///            perturbation after Edelsbrunner and Mücke, "Simulation of Simplicity", ACM TOG 9(1), 1990, at the border;
///          spheres, Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection",
///            Ray Tracing Gems, 2019, chapter 7.
class Caster {
  public:
    Caster(const dvec3& origin, const dvec3& direction);

    /// Nothing for a triangle seen edge on or without area. t may be negative.
    std::optional<TriangleHit> triangle(const std::array<dvec3, 3>& vertices, Border border) const;
    /// Nothing if the line misses it. A tangent has near = far.
    std::optional<SphereHits> sphere(const dvec3& center, double radius) const;
    /// Nothing for a parallel plane. t may be negative.
    std::optional<double> plane(const dvec3& point, const dvec3& normal) const;

  private:
    dvec3 origin_;
    dvec3 direction_;
    int kx_, ky_, kz_;  // kz_: the largest component of the direction; (kx_, ky_, kz_) keeps the winding
    dvec3 shear_;       // takes the direction to (0, 0, 1)
};

}  // namespace raymill::reference
