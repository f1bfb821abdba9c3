// What the tracer on Embree reads of a scene: the records of the kernels' border, and small vectors from them.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "wavefront/records.hpp"

namespace raymill::bench {

using glm::vec2;
using glm::vec3;

inline vec3 vec(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// The scene must outlive this.
struct World {
    explicit World(const Scene& s)
        : scene(s),
          materials(material_records(s)),
          lights(light_records(s)),
          slots(light_slots(s)),
          camera(camera_record(s)),
          constants(scene_constants(s, 0, {})) {}

    const Material& material_of(std::uint32_t primitive) const {
        if (primitive < scene.triangles.size()) return materials[scene.triangles[primitive].material];
        const std::size_t index = primitive - scene.triangles.size();
        if (index < scene.spheres.size()) return materials[scene.spheres[index].material];
        return materials[scene.planes[index - scene.spheres.size()].material];
    }

    const Scene& scene;
    std::vector<Material> materials;
    std::vector<LightRecord> lights;
    std::vector<LightSlot> slots;
    CameraRecord camera;
    SceneConstants constants;
};

/// A ray of a path: unit direction, and what keys its random numbers.
struct PathRay {
    vec3 origin;
    vec3 direction;
    std::uint32_t path;
    std::uint32_t sample;
};

/// u and v weigh vertices 1 and 2 of a triangle. primitive: NO_INDEX for a miss.
struct PathHit {
    float t = INFINITY;
    float u = 0;
    float v = 0;
    std::uint32_t primitive = NO_INDEX;
};

}  // namespace raymill::bench
