// A scene on a device, for profiling its frames.
#pragma once

#include "bvh/bvh.hpp"
#include "scene/scene.hpp"
#include "wavefront/renderer.hpp"

namespace raymill {

/// Reflects, refracts, misses and ends by depth, weight and surface; five light samples, so two passes.
inline Scene branching_scene() {
    Scene scene = load_scene(RAYMILL_SOURCE_DIR "/tests/verify/branching.toml");
    scene.settings.min_weight = 0.05f;
    return scene;
}

/// A hierarchy of the scene's own, so that the renderer's references outlive it.
struct ProfiledScene {
    explicit ProfiledScene(std::uint64_t queue_capacity = 256, std::size_t work_group = 0,
                           const std::string& kernels = {}, const FilmPlanes& planes = {},
                           Scene rendered = branching_scene(), Traversal traversal = Traversal::automatic)
        : device(open_device("", 0)),
          scene(std::move(rendered)),
          bvh(build_bvh(scene.vertices, scene.triangles, scene.spheres)) {
        RenderOptions options;
        options.memory.queue_capacity = queue_capacity;
        options.work_group = work_group;
        options.kernel_dir = kernels;
        options.planes = planes;
        options.traversal = traversal;
        renderer.emplace(device, scene, bvh, options);
    }

    Device device;
    Scene scene;
    Bvh bvh;
    std::optional<Renderer> renderer;
};

}  // namespace raymill
