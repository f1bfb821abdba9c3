// PLY files into the scene.
#pragma once

#include <string>

#include "scene/mesh_file.hpp"

namespace raymill {

/// Reads a PLY file and appends it as one object. Without a material of the placement it has the default one, or, where
/// the file has colours or names a texture, that with those as its diffuse colour; a missing texture is a warning.
void load_ply(Loading& loading, const std::string& path, const MeshPlacement& placement,
              const SourcePosition& named_at);

}  // namespace raymill
