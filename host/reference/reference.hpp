// The scalar reference: a plain recursive ray tracer in double precision, one ray at a time, all primitives by brute
// force. It shares nothing with the kernels but the scene and the integer random numbers, and is slow on purpose.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.hpp"

namespace raymill::reference {

using glm::dvec2;
using glm::dvec3;

struct Ray {
    dvec3 origin;
    dvec3 direction;  // any length but zero; distances are in multiples of it
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
    dvec2 uv;
    std::uint32_t material = 0;
    std::uint32_t object = 0;
    bool inside = false;  // the ray arrives from behind the outward geometric normal
};

/// What one light sample gives to a point.
struct LightSample {
    dvec3 direction;  // unit, towards the light
    double distance = INFINITY;
    dvec3 incoming{0};  // I_in; zero where the light does not shine
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

class Tracer {
  public:
    explicit Tracer(const Scene& scene);

    /// The camera ray of sample `sample` of pixel (x, y) of the whole image.
    Ray camera_ray(int x, int y, std::uint32_t sample) const;

    /// Closest hit with t > t_min; equal distances: lowest id.
    Hit intersect(const Ray& ray, double t_min = 0) const;
    /// Same, against one primitive alone: for explaining a disagreement.
    Hit intersect_primitive(const Ray& ray, std::uint32_t primitive, double t_min = 0) const;
    Surface surface(const Ray& ray, const Hit& hit) const;

    /// Sample `light_sample` of light `light` (index into Scene::lights) seen from p, on the path `path` of camera
    /// sample `sample`: number sample * samples + light_sample of the spp * samples stratified points of
    /// random_key(path, RANDOM_LIGHT + light).
    LightSample sample_light(std::uint32_t light, std::uint32_t light_sample, const dvec3& p, std::uint32_t sample,
                             std::uint32_t path) const;
    /// Phong, Blinn, flat, Gouraud as the material says, for that light sample. `ray` is the one that hit.
    LocalTerms local_terms(const Ray& ray, const Hit& hit, const Surface& surface, std::uint32_t light,
                           std::uint32_t light_sample, std::uint32_t sample, std::uint32_t path) const;
    /// 1 where the light is visible, 0 where blocked, a colour through filters.
    dvec3 visibility(const dvec3& origin, const dvec3& direction, double distance) const;
    Split split(const Ray& ray, const Surface& surface) const;

    /// Radiance that arrives along `ray`, children included.
    dvec3 radiance(const Ray& ray, int depth, std::uint32_t sample, std::uint32_t path) const;
    /// Mean of the pixel's samples: R, G, B, coverage.
    glm::dvec4 pixel(int x, int y) const;

  private:
    const Scene& scene_;
};

}  // namespace raymill::reference
