// OBJ files into the scene.
#pragma once

#include <optional>
#include <string>

#include "scene/loading.hpp"
#include "scene/transform.hpp"

namespace raymill {

/// How a mesh file is placed in the scene.
struct MeshPlacement {
    std::string name;                       // of the object; the file's groups keep their own names
    std::optional<std::uint32_t> material;  // for all of it; else the file's own, and materials[0] for faces without
    Transform transform;
    std::optional<double> smooth_angle;  // degrees; replaces the file's normals
};

/// Reads an OBJ file and the MTL files and textures it names (beside it), and appends its faces: an object for each `o`
/// or `g` with faces. Missing MTL files, materials and textures are warnings; all else goes to loading.errors.
/// `named_at` is where the file is named, for a file that cannot be read.
void load_obj(Loading& loading, const std::string& path, const MeshPlacement& placement,
              const SourcePosition& named_at);

}  // namespace raymill
