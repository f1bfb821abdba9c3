// A scene around a bare model: a camera that frames it, two lights and a little ambient light.
#pragma once

#include <string>
#include <vector>

#include "scene/mesh_file.hpp"

namespace raymill {

/// Camera and lights for a model. What is made up here has six digits, so that it can be written down exactly.
struct ModelFraming {
    Camera camera;
    std::vector<SceneLight>
        lights;           // the file's own; else a key and a fill light, white and not attenuated, and ambient
    double exposure = 0;  // stops
};

/// Frames the triangles of the scene: those with finite vertices, and without lamps where there is anything else.
/// A room, which is a box of walls open towards exactly one of +z, -z, +x, -x (in this order), is seen through its open
/// side; it is lit from below its lamps, or its ceiling where it has none, and from the eye. A closed room, whose six
/// walls are opaque and have something between them, is seen from inside. All else is seen from the right, 30 degrees
/// off +z and 20 degrees above the horizon. The lights are such that a diffuse surface of 0.8 stays below 1.
/// A camera and lights of the file take the place of these. Its lights may be of any unit and strength: the exposure is
/// such that they show a white surface in the middle of the model, turned to all of them, at 0.8.
ModelFraming frame_model(const Scene& scene, const FileView& file);

/// Loads a bare model with its framing; the same as loading the text of model_scene_toml.
void read_model(Loading& loading, const std::string& file);

}  // namespace raymill
