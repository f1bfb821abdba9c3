#include "scene/obj_material.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/texture.hpp"

namespace raymill {
namespace {

constexpr int no_illum = -1;

/// The text without comments, and with "illum -1" at the head of each material, so that one without illum shows.
std::string prepared(const std::string& text) {
    std::istringstream lines(text);
    std::string line, result;
    result.reserve(text.size() + text.size() / 8);
    while (std::getline(lines, line)) {
        for (std::size_t i = 0; i < line.size(); ++i)
            if (line[i] == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) line.resize(i);
        const std::size_t last = line.find_last_not_of(" \t\r");
        line.resize(last == std::string::npos ? 0 : last + 1);
        result += line + '\n';
        const std::size_t first = line.find_first_not_of(" \t");
        if (first != std::string::npos && line.compare(first, 6, "newmtl") == 0)
            result += fmt::format("illum {}\n", no_illum);
    }
    return result;
}

float positive(float value) {
    return value > 0 && std::isfinite(value) ? value : 0;
}

glm::vec3 color(const float (&values)[3]) {
    return {positive(values[0]), positive(values[1]), positive(values[2])};
}

float largest(const glm::vec3& c) {
    return std::max({c.r, c.g, c.b});
}

bool is_glass(const tinyobj::material_t& mtl) {
    // Without illum an index of refraction must tell glass: glossy paint comes with Tf too.
    if (mtl.illum == no_illum) return mtl.ior > 1 && (largest(color(mtl.transmittance)) > 0 || mtl.dissolve < 1);
    return mtl.illum == 4 || mtl.illum == 6 || mtl.illum == 7 || mtl.illum == 9;
}

bool is_mirror(const tinyobj::material_t& mtl) {
    if (mtl.illum == no_illum) return is_glass(mtl) || largest(color(mtl.diffuse)) == 0;
    return mtl.illum >= 3;
}

void set_secondary_rays(const tinyobj::material_t& mtl, SceneMaterial& material) {
    const glm::vec3 specular = color(mtl.specular), filter = color(mtl.transmittance);
    const float veil = std::clamp(1 - positive(mtl.dissolve), 0.0f, 1.0f);
    const bool glass = is_glass(mtl);
    material.reflection = is_mirror(mtl) ? std::min(largest(specular), 1.0f) : 0;
    material.transmission = glass && largest(filter) > 0 ? std::min(largest(filter), 1.0f) : veil;
    material.ior = glass && positive(mtl.ior) > 0 ? mtl.ior : 1;
    material.fresnel = glass && (mtl.illum == 7 || mtl.illum == no_illum);
    const glm::vec3 tint = glass && largest(filter) > 0 ? filter : material.reflection > 0 ? specular : glm::vec3(1);
    material.base_color = tint / largest(tint);
    const float sum = material.reflection + material.transmission;
    if (sum > 1) {
        material.reflection /= sum;
        material.transmission = 1 - material.reflection;
    }
}

SceneMaterial scene_material(const tinyobj::material_t& mtl) {
    SceneMaterial material;
    material.name = mtl.name;
    material.ambient = color(mtl.ambient);
    material.diffuse = color(mtl.diffuse);
    material.specular = mtl.illum == 1 ? glm::vec3(0) : color(mtl.specular);
    material.shininess = positive(mtl.shininess);
    material.emission = color(mtl.emission);
    set_secondary_rays(mtl, material);
    return material;
}

/// The parameters of the material that have no counterpart, in MTL's words.
std::string not_supported(const tinyobj::material_t& mtl) {
    std::vector<std::string> names;
    const auto add = [&](bool present, const char* name) {
        if (present) names.emplace_back(name);
    };
    add(!mtl.ambient_texname.empty() && mtl.ambient_texname != mtl.diffuse_texname, "map_Ka");
    add(!mtl.specular_texname.empty(), "map_Ks");
    add(!mtl.specular_highlight_texname.empty(), "map_Ns");
    add(!mtl.emissive_texname.empty(), "map_Ke");
    add(!mtl.alpha_texname.empty(), "map_d");
    add(!mtl.bump_texname.empty(), "map_Bump");
    add(!mtl.normal_texname.empty(), "norm");
    add(!mtl.displacement_texname.empty(), "disp");
    add(!mtl.reflection_texname.empty(), "refl");
    add(!mtl.roughness_texname.empty() || mtl.roughness != 0, "Pr");
    add(!mtl.metallic_texname.empty() || mtl.metallic != 0, "Pm");
    add(!mtl.sheen_texname.empty() || mtl.sheen != 0, "Ps");
    add(mtl.clearcoat_thickness != 0, "Pc");
    add(mtl.clearcoat_roughness != 0, "Pcr");
    add(mtl.anisotropy != 0, "aniso");
    add(mtl.anisotropy_rotation != 0, "anisor");
    const tinyobj::texture_option_t& options = mtl.diffuse_texopt;
    const bool moved = options.origin_offset[0] != 0 || options.origin_offset[1] != 0 || options.scale[0] != 1 ||
                       options.scale[1] != 1 || options.turbulence[0] != 0 || options.turbulence[1] != 0;
    add(moved || options.clamp || options.brightness != 0 || options.contrast != 1, "the options of map_Kd");
    for (const auto& [name, value] : mtl.unknown_parameter) names.push_back(name);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string with_forward_slashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    return path;
}

}  // namespace

bool MaterialLibrary::add_file(Loading& loading, const std::string& path, std::string& reason) {
    const std::optional<std::string> text = loading.files.read(path, reason);
    if (!text) return false;
    std::istringstream stream(prepared(*text));
    std::map<std::string, int> index_of_name;
    std::vector<tinyobj::material_t> materials;
    // Its one warning, that both d and Tr are there, tells what the format says anyway: d wins.
    tinyobj::LoadMtl(&index_of_name, &materials, &stream, nullptr, nullptr);
    for (const auto& [name, index] : index_of_name) {
        const tinyobj::material_t& mtl = materials[static_cast<std::size_t>(index)];
        if (name.empty()) continue;  // what tinyobjloader reports for a file without materials
        Entry entry{scene_material(mtl), path, {}, not_supported(mtl), {}};
        if (!mtl.diffuse_texname.empty())
            entry.diffuse_texture = path_beside(path, with_forward_slashes(mtl.diffuse_texname));
        entries_.try_emplace(name, std::move(entry));
    }
    return true;
}

std::optional<std::uint32_t> MaterialLibrary::use(Loading& loading, const std::string& name) {
    const auto found = entries_.find(name);
    if (found == entries_.end()) return std::nullopt;
    Entry& entry = found->second;
    if (entry.index) return entry.index;
    if (!entry.not_supported.empty())
        loading.warn({entry.file}, fmt::format("material \"{}\": these are not supported and left out: {}", name,
                                               entry.not_supported));
    if (!entry.diffuse_texture.empty())
        entry.material.diffuse_map = load_texture(loading, entry.diffuse_texture, {entry.file}, true);
    entry.index = static_cast<std::uint32_t>(loading.scene.materials.size());
    loading.scene.materials.push_back(std::move(entry.material));
    return entry.index;
}

}  // namespace raymill
