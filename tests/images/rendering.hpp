// Scenes from text, frames from scenes: what every image test starts with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "bvh/bvh.hpp"
#include "device/device.hpp"
#include "scene/scene.hpp"
#include "wavefront/renderer.hpp"

namespace raymill {

/// The scene of this TOML text. Its files may be checker.exr, 8 x 8 texels of different colours.
Scene scene_of(const std::string& toml);

/// The default device with all its threads, opened once a program.
const Device& test_device();

inline Bvh bvh_of(const Scene& scene) {
    return build_bvh(scene.vertices, scene.triangles, scene.spheres);
}

inline RenderOptions options_with(std::uint64_t queue_capacity, std::size_t work_group = 0) {
    RenderOptions options;
    options.memory.queue_capacity = queue_capacity;
    options.work_group = work_group;
    return options;
}

/// One whole frame; a queue of 4096 rays unless the options say otherwise. Fails the test if the film lost anything.
Frame render(const Scene& scene, const RenderOptions& options = options_with(4096),
             const Device& device = test_device());

std::uint64_t pixel_count(const Scene& scene);

/// Pixels whose integer sums differ in any channel.
std::size_t differing_pixels(const Frame& a, const Frame& b);

/// A sphere of about 2 * bands * bands triangles as TOML keys `vertices`, `normals`, `faces` of a mesh object.
std::string sphere_mesh_keys(double x, double y, double z, double radius, int bands);

/// A square grid in the plane y = 0 of cells * cells quads, side 2 * half, as TOML keys of a mesh object.
std::string grid_mesh_keys(double half, int cells);

}  // namespace raymill
