// glTF's mesh primitives as triangles of the scene.
#pragma once

#include "scene/gltf_material.hpp"
#include "scene/mesh_file.hpp"

namespace raymill {

/// Where the triangles of a node's mesh go.
struct GltfTarget {
    Transform transform;
    std::uint32_t object = 0;
    std::optional<std::uint32_t> material;  // in place of the file's own
    std::optional<double> smooth_angle;
};

/// Appends the triangles of all primitives of the mesh: lists, strips and fans, with and without indices; positions,
/// normals, the set of texture coordinates that the base colour uses, and COLOR_0, which is linear and multiplies the
/// base colour where that has no texture. Points, lines and primitives without positions are left out. Throws
/// SceneError.
void append_gltf_mesh(Loading& loading, GltfFile& file, GltfMaterials& materials, const GltfValue& mesh,
                      const GltfTarget& target);

}  // namespace raymill
