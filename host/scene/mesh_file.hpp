// Files of meshes: OBJ, PLY and glTF, told apart by their extension.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

/// What a file says beside its meshes: a bare model is seen and lit by it.
struct FileView {
    std::optional<Camera> camera;
    std::vector<SceneLight> lights;
};

/// Whether a file of this name is a mesh by its extension: .obj, .ply, .gltf or .glb.
bool is_mesh_file(const std::string& path);

/// The formats that are read, for messages: ".obj, .ply, .gltf or .glb".
extern const char* const mesh_extensions;

/// Appends the triangles, materials, textures and objects of the file. Faults go to loading.errors, those that leave
/// something out to the warnings. `named_at` is where the file is named, for a file that cannot be read. Precondition:
/// is_mesh_file(path).
FileView load_mesh_file(Loading& loading, const std::string& path, const MeshPlacement& placement,
                        const SourcePosition& named_at);

}  // namespace raymill
