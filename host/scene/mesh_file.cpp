#include "scene/mesh_file.hpp"

#include "scene/gltf_loader.hpp"
#include "scene/obj_loader.hpp"
#include "scene/ply_loader.hpp"

namespace raymill {

const char* const mesh_extensions = ".obj, .ply, .gltf or .glb";

bool is_mesh_file(const std::string& path) {
    const std::string extension = extension_of(path);
    return extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb";
}

FileView load_mesh_file(Loading& loading, const std::string& path, const MeshPlacement& placement,
                        const SourcePosition& named_at) {
    const std::string extension = extension_of(path);
    if (extension == ".gltf" || extension == ".glb") return load_gltf(loading, path, placement, named_at);
    if (extension == ".ply")
        load_ply(loading, path, placement, named_at);
    else
        load_obj(loading, path, placement, named_at);
    return {};
}

}  // namespace raymill
