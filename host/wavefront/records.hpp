// The scene's materials, lights and camera as the kernels read them.
#pragma once

#include <vector>

#include "scene/scene.hpp"
#include "wavefront/film_planes.hpp"

namespace raymill {

std::vector<Material> material_records(const Scene& scene);

/// The lights that shade: all but ambient and environment. `index` of a record is its place in Scene::lights, which keys
/// its random numbers, so the list has one entry a scene light; entries of the other kinds are never referred to.
std::vector<LightRecord> light_records(const Scene& scene);

/// One entry a light sample, in the order of the lights.
std::vector<LightSlot> light_slots(const Scene& scene);

CameraRecord camera_record(const Scene& scene);

/// node_count: of the hierarchy.
SceneConstants scene_constants(const Scene& scene, std::size_t node_count, const FilmPlanes& planes);

/// Pixels of the rendered window.
std::uint64_t film_pixels(const Scene& scene);

/// Camera rays of a frame.
std::uint64_t camera_samples(const Scene& scene);

/// Whether any material reflects or transmits: else no secondary rays exist.
bool spawns_secondary_rays(const Scene& scene);

}  // namespace raymill
