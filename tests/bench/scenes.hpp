// The benchmark's scenes: geometry of known kinds and any size, a camera, and a lamp.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace raymill::bench {

/// A lamp: a point for hard shadows, and a square of this edge around it, square to `axis`, for soft ones.
struct Lamp {
    glm::vec3 position{0};
    float edge = 1;
    glm::vec3 axis{0, -1, 0};  // unit
};

/// A scene of triangles and spheres alone; materials and lights play no part.
struct BenchScene {
    std::string name;
    Scene scene;
    Lamp lamp;
};

/// One that the program makes. `make` takes the number of triangles to aim at (for the spheres, ten of them count as
/// one sphere).
struct Recipe {
    std::string name;
    std::string description;
    std::function<BenchScene(double triangles)> make;
};

const std::vector<Recipe>& recipes();

/// A scene of the program's own formats, or a bare model, which is framed. What Embree does not have is left out:
/// infinite planes, skies, and shadows that surfaces filter. The lamp stands at the first point light, else above the
/// way from the eye to the middle of the bounds. Throws SceneError.
BenchScene load_bench_scene(const std::string& file);

}  // namespace raymill::bench
