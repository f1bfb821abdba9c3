#include "scene/ply_loader.hpp"

#include <fmt/format.h>

#include "scene/ply_reader.hpp"
#include "scene/texture.hpp"

namespace raymill {
namespace {

/// The material of a file with colours or a texture; materials[0] for one without.
std::uint32_t own_material(Loading& loading, const std::string& path, PlyFile& ply) {
    SceneMaterial material;
    if (!ply.mesh.corner_colors.empty()) {
        const BakedColors colors = bake_colors(loading.scene, ply.mesh, path);
        material.name = "vertex colors";
        material.diffuse = colors.color;
        material.diffuse_map = colors.image;
    } else if (!ply.textures.empty()) {
        if (ply.textures.size() > 1)
            loading.warn({path}, fmt::format("of {} textures the first is used for all faces", ply.textures.size()));
        material.name = ply.textures[0];
        material.diffuse_map = load_texture(loading, path_beside(path, ply.textures[0]), {path}, true);
        if (!material.diffuse_map) return 0;
        material.diffuse = glm::vec3(1);
    } else {
        return 0;
    }
    loading.scene.materials.push_back(std::move(material));
    return static_cast<std::uint32_t>(loading.scene.materials.size() - 1);
}

}  // namespace

void load_ply(Loading& loading, const std::string& path, const MeshPlacement& placement,
              const SourcePosition& named_at) {
    std::string reason;
    const std::optional<std::string> bytes = loading.files.read(path, reason);
    if (!bytes) return loading.error(named_at, fmt::format("cannot read the mesh \"{}\": {}", path, reason));
    PlyFile ply;
    try {
        ply = read_ply(*bytes, path);
    } catch (const SceneError& error) {
        loading.errors.insert(loading.errors.end(), error.diagnostics().begin(), error.diagnostics().end());
        return;
    }
    Scene& scene = loading.scene;
    scene.warnings.insert(scene.warnings.end(), ply.warnings.begin(), ply.warnings.end());
    if (ply.mesh.triangles.empty()) loading.warn({path}, "there are no faces in this file");
    if (placement.smooth_angle) smooth_by_angle(ply.mesh, *placement.smooth_angle);
    const std::uint32_t material = placement.material ? *placement.material : own_material(loading, path, ply);
    scene.objects.push_back({placement.name, "mesh", 0});
    append_mesh(scene, ply.mesh, placement.transform, material, static_cast<std::uint32_t>(scene.objects.size() - 1));
}

}  // namespace raymill
