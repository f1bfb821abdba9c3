// A scene around a bare model: a camera that frames it, two lights and a little ambient light.
#pragma once

#include <string>
#include <variant>

#include "scene/loading.hpp"

namespace raymill {

/// Camera and lights for a model, in numbers of six digits, so that they can be written down exactly.
struct ModelFraming {
    Camera camera;
    std::variant<DirectionalLight, PointLight> key;  // white, as is the fill; point lights are not attenuated
    std::variant<DirectionalLight, PointLight> fill;
    AmbientLight ambient;
};

/// Frames the triangles of the scene: those with finite vertices, and without lamps where there is anything else.
/// A room, which is a box of walls open towards exactly one of +z, -z, +x, -x (in this order), is seen through its open
/// side; it is lit from below its lamps, or its ceiling where it has none, and from the eye. A closed room, whose six
/// walls are opaque and have something between them, is seen from inside. All else is seen from the right, 30 degrees
/// off +z and 20 degrees above the horizon. The lights are such that a diffuse surface of 0.8 stays below 1.
ModelFraming frame_model(const Scene& scene);

/// Loads a bare OBJ file with its framing; the same as loading the text of model_scene_toml.
void read_model(Loading& loading, const std::string& file);

}  // namespace raymill
