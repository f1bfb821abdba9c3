// OBJ files into the scene.
#pragma once

#include <string>

#include "scene/mesh_file.hpp"

namespace raymill {

/// Reads an OBJ file and the MTL files and textures it names (beside it), and appends its faces: an object for each `o`
/// or `g` with faces. Missing MTL files, materials and textures are warnings; all else goes to loading.errors.
/// `named_at` is where the file is named, for a file that cannot be read.
void load_obj(Loading& loading, const std::string& path, const MeshPlacement& placement,
              const SourcePosition& named_at);

}  // namespace raymill
