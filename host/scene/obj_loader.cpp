#include "scene/obj_loader.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "scene/obj_material.hpp"
#include "scene/obj_reader.hpp"

namespace raymill {
namespace {

/// The file names of a mtllib line: the whole of it if there is such a file, else its words, where "\ " is a blank.
std::vector<std::string> library_files(const std::string& obj_path, const std::string& names) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path_beside(obj_path, names), ignored)) return {names};
    std::vector<std::string> files;
    std::string word;
    for (std::size_t i = 0; i <= names.size(); ++i) {
        const bool blank = i == names.size() || names[i] == ' ' || names[i] == '\t';
        if (blank && !word.empty() && i < names.size() && word.back() == '\\') {
            word.back() = ' ';
        } else if (!blank) {
            word += names[i];
        } else if (!word.empty()) {
            files.push_back(std::move(word));
            word.clear();
        }
    }
    return files;
}

MaterialLibrary read_libraries(Loading& loading, const std::string& obj_path, const ObjFile& obj) {
    MaterialLibrary library;
    for (const auto& [names, line] : obj.libraries)
        for (const std::string& name : library_files(obj_path, names)) {
            std::string reason;
            if (!library.add_file(loading, path_beside(obj_path, name), reason))
                loading.warn({obj_path, line, 0},
                             fmt::format("cannot read the material file \"{}\": {}", name, reason));
        }
    return library;
}

/// Turns the indices of material names into indices of scene materials.
void resolve_materials(Loading& loading, const std::string& obj_path, ObjFile& obj) {
    MaterialLibrary library = read_libraries(loading, obj_path, obj);
    std::vector<std::optional<std::uint32_t>> index_of_name(obj.material_names.size());
    for (std::uint32_t& material : obj.mesh.materials) {
        if (material == NO_INDEX) {
            material = 0;
            continue;
        }
        std::optional<std::uint32_t>& index = index_of_name[material];
        if (!index) {
            const std::string& name = obj.material_names[material];
            index = library.use(loading, name);
            if (!index) {
                loading.warn({obj_path, obj.material_lines[material], 0},
                             fmt::format("there is no material \"{}\": its faces get the default one", name));
                index = 0;
            }
        }
        material = *index;
    }
}

void add_objects(Scene& scene, const MeshPlacement& placement, ObjFile& obj) {
    const auto first = static_cast<std::uint32_t>(scene.objects.size());
    for (const std::string& name : obj.object_names)
        scene.objects.push_back({name.empty() ? placement.name : name, "mesh", 0});
    for (std::uint32_t& object : obj.mesh.objects) object += first;
}

}  // namespace

void load_obj(Loading& loading, const std::string& path, const MeshPlacement& placement,
              const SourcePosition& named_at) {
    std::string reason;
    const std::optional<std::string> text = loading.files.read(path, reason);
    if (!text) return loading.error(named_at, fmt::format("cannot read the mesh \"{}\": {}", path, reason));
    ObjFile obj = read_obj(*text, path);
    auto& warnings = loading.scene.warnings;
    warnings.insert(warnings.end(), obj.warnings.begin(), obj.warnings.end());
    loading.errors.insert(loading.errors.end(), obj.errors.begin(), obj.errors.end());
    if (!obj.errors.empty()) return;
    if (obj.mesh.triangles.empty()) loading.warn({path}, "there are no faces in this file");
    if (placement.smooth_angle)
        smooth_by_angle(obj.mesh, *placement.smooth_angle);
    else
        smooth_by_groups(obj.mesh);
    if (placement.material)
        obj.mesh.materials.clear();
    else
        resolve_materials(loading, path, obj);
    add_objects(loading.scene, placement, obj);
    append_mesh(loading.scene, obj.mesh, placement.transform, placement.material.value_or(0), 0);
}

}  // namespace raymill
