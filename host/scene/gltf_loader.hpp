// glTF files into the scene.
#pragma once

#include "scene/mesh_file.hpp"

namespace raymill {

/// Reads a .gltf or .glb file with its buffers and textures and appends the meshes of its default scene (the first
/// without one; all nodes without any), an object for each node with a mesh. Returns the first camera of the scene and
/// the lights of KHR_lights_punctual, in the file's own space. Faults go to loading.errors; what is left out is named
/// in one warning.
///
/// Lights: glTF's candela and lux light a white diffuse surface with E / pi where the lecture's give E, so intensities
/// are divided by pi; point and spot lights fall off with the square of the distance, without `range`.
FileView load_gltf(Loading& loading, const std::string& path, const MeshPlacement& placement,
                   const SourcePosition& named_at);

}  // namespace raymill
