// The scalar reference: a plain recursive ray tracer in double precision, one ray at a time, all primitives by brute
// force. It shares nothing with the kernels but the scene and the integer random numbers, and is slow on purpose.
//
// A ray that starts on a surface must not meet that surface at its start. In double precision no offset is needed:
// the ray names the primitive it starts on, which a triangle or plane can never meet again and a sphere only at the far
// end of the chord; and it ignores what lies within 1e-9 of the size of the coordinates around its start, far above the
// rounding error of the hit point (some 1e-15) and far below what single precision tells apart (1e-7), so that the
// neighbours across a shared edge are not met either. RenderSettings::shadow_offset = none is ignored.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.hpp"

namespace raymill::reference {

using glm::dvec2;
using glm::dvec3;

struct Ray {
    dvec3 origin;
    dvec3 direction;                // any length but zero; distances are in multiples of it
    std::uint32_t from = NO_INDEX;  // the primitive it starts on
    double clearance = 0;           // nothing is met up to this distance
};

/// A point where a ray meets a primitive. u, v weigh vertices 1 and 2 of a triangle. primitive: id, or NO_INDEX.
struct Hit {
    double t = INFINITY;
    double u = 0;
    double v = 0;
    std::uint32_t primitive = NO_INDEX;
};

/// The surface at a hit. Normals are unit and outward as the geometry says (not flipped to the ray).
struct Surface {
    dvec3 position;
    dvec3 geometric_normal;
    dvec3 shading_normal;
    dvec2 uv{0};  // zero on spheres, planes and triangles without texture coordinates
    std::uint32_t material = 0;
    std::uint32_t object = 0;
    bool smooth = false;  // the shading normal is interpolated from the vertices
    bool inside = false;  // the ray arrives from behind the outward geometric normal
};

/// What one light sample gives to a point.
struct LightSample {
    dvec3 direction{0};  // unit, towards the light; zero where there is none to tell
    double distance = INFINITY;
    double shadow_distance = INFINITY;  // where the shadow segment ends: just before the lamp
    dvec3 incoming{0};                  // I_in over the light's samples; zero where the light does not shine
};

/// Diffuse and specular terms of one light sample, without visibility.
struct LocalTerms {
    dvec3 diffuse{0};
    dvec3 specular{0};
};

/// How a hit's energy goes on; a zero weight spawns no ray.
struct Split {
    double local = 1;
    double reflection = 0;
    double transmission = 0;
    dvec3 reflected{0};  // unit directions
    dvec3 refracted{0};
};

/// Renders a scene that must outlive it and was validated by the loader. const and without state: threads may share it.
class Tracer {
  public:
    explicit Tracer(const Scene& scene);

    /// The camera ray of sample `sample` of pixel (x, y) of the whole image. Unit direction.
    Ray camera_ray(int x, int y, std::uint32_t sample) const;

    /// Closest hit with t > max(t_min, ray.clearance); equal distances: lowest id. Edges belong to triangles.
    Hit intersect(const Ray& ray, double t_min = 0) const;
    /// Same, against one primitive alone: for explaining a disagreement.
    Hit intersect_primitive(const Ray& ray, std::uint32_t primitive, double t_min = 0) const;
    /// The position lies on the primitive as closely as doubles allow, exactly so across an axis-aligned one.
    Surface surface(const Ray& ray, const Hit& hit) const;
    /// The ray that leaves a hit in a unit direction.
    Ray spawn(const Ray& ray, const Hit& hit, const Surface& surface, const dvec3& direction) const;

    /// The ray towards a light sample. On smooth triangles it starts on the curved surface that the vertex normals
    /// describe, so that a coarse mesh casts no steps of shadow on itself.
    Ray shadow_ray(const Ray& ray, const Hit& hit, const Surface& surface, const LightSample& light) const;

    /// What a ray of this unit direction brings home when it misses: background and environment lights.
    dvec3 background(const dvec3& direction) const;
    /// k_d with texture and checker. The checker replaces the plain colour, the texture multiplies either.
    dvec3 diffuse_color(const Surface& surface) const;
    /// k_a I_a.
    dvec3 ambient_term(const Surface& surface) const;
    /// Radiance of the surface itself to the side that the ray came from.
    dvec3 emission(const Surface& surface) const;

    /// Sample `light_sample` of light `light` (index into Scene::lights) seen from p, on the path `path` of camera
    /// sample `sample`: number sample * samples + light_sample of the stratified points of
    /// random_key(path, RANDOM_LIGHT + light). Ambient and environment lights give nothing.
    LightSample sample_light(std::uint32_t light, std::uint32_t light_sample, const dvec3& p, std::uint32_t sample,
                             std::uint32_t path) const;
    /// Phong, Blinn, flat, Gouraud as the material says, for that light sample. `ray` is the one that hit.
    LocalTerms local_terms(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t light,
                           std::uint32_t light_sample, std::uint32_t sample, std::uint32_t path) const;
    /// 1 where the light is visible, 0 where blocked, a colour through filters; `distance` along the ray's direction.
    dvec3 visibility(const Ray& ray, double distance) const;
    dvec3 visibility(const dvec3& origin, const dvec3& direction, double distance) const;
    /// Where a hit's energy goes. Past the critical angle the reflected ray carries the weight of both.
    Split split(const Ray& ray, const Surface& surface) const;

    /// Radiance that arrives along `ray`, children included. depth: that of the ray itself, 0 for a camera ray.
    dvec3 radiance(const Ray& ray, int depth, std::uint32_t sample, std::uint32_t path) const;
    /// Mean of the pixel's samples: R, G, B, coverage.
    glm::dvec4 pixel(int x, int y) const;

  private:
    using Corners = std::array<dvec3, 3>;

    const SceneMaterial& material_of(std::uint32_t primitive) const;
    bool is_flat(std::uint32_t primitive) const;
    dvec3 smooth_lift(const Hit& hit, const Surface& surface) const;
    LightSample light_at_vertex(std::uint32_t light, const LightSample& at_hit, const dvec3& p,
                                const dvec3& vertex) const;
    LocalTerms gouraud_terms(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t light,
                             const LightSample& at_hit) const;
    dvec3 direct_light(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t sample,
                       std::uint32_t path) const;
    dvec3 trace(const Ray& ray, int depth, std::uint32_t sample, std::uint32_t path, const dvec3& throughput) const;
    dvec3 shade(const Ray& ray, const Hit& hit, int depth, std::uint32_t sample, std::uint32_t path,
                const dvec3& throughput) const;

    const Scene& scene_;
    std::vector<Corners> corners_;  // of the triangles
};

/// Components of a border struct as doubles.
inline dvec3 to_dvec3(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

}  // namespace raymill::reference
