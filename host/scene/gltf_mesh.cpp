#include "scene/gltf_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scene/vertex_colors.hpp"

namespace raymill {
namespace {

constexpr std::uint64_t mode_triangles = 4, mode_strip = 5, mode_fan = 6;
constexpr const char* scalar_type[] = {"SCALAR"};
constexpr const char* vec2_type[] = {"VEC2"};
constexpr const char* vec3_type[] = {"VEC3"};
constexpr const char* color_types[] = {"VEC3", "VEC4"};
constexpr int index_types[] = {5121, 5123, 5125};
constexpr int color_component_types[] = {5121, 5123, 5126};

/// An attribute with as many elements as there are positions (or any number where none are known yet).
std::optional<GltfNumbers> read_attribute(GltfFile& file, const GltfValue& attributes, const std::string& name,
                                          std::span<const char* const> types, std::span<const int> component_types,
                                          std::optional<std::size_t> count) {
    const std::optional<GltfValue> reference = attributes.find(name);
    if (!reference) return std::nullopt;
    GltfNumbers numbers = file.accessor(*reference, types, component_types);
    if (count && numbers.count != *count)
        reference->fail(fmt::format("has {} elements, but POSITION has {}", numbers.count, *count));
    return numbers;
}

std::vector<std::uint32_t> read_indices(GltfFile& file, const GltfValue& primitive, std::size_t vertices) {
    std::vector<std::uint32_t> indices;
    const std::optional<GltfValue> reference = primitive.find("indices");
    if (!reference) {
        for (std::size_t i = 0; i < vertices; ++i) indices.push_back(static_cast<std::uint32_t>(i));
        return indices;
    }
    const GltfNumbers numbers = file.accessor(*reference, scalar_type, index_types);
    indices.reserve(numbers.count);
    for (const double index : numbers.values) {
        if (!(index < static_cast<double>(vertices)))
            reference->fail(fmt::format("refers to vertex {}, but there are {}, counted from 0", index, vertices));
        indices.push_back(static_cast<std::uint32_t>(index));
    }
    return indices;
}

/// Section 3.7.2.1: the winding of strips alternates, the first vertex of fans stays.
std::vector<std::array<std::uint32_t, 3>> faces_of(const std::vector<std::uint32_t>& indices, std::uint64_t mode) {
    std::vector<std::array<std::uint32_t, 3>> faces;
    if (mode == mode_triangles)
        for (std::size_t i = 2; i < indices.size(); i += 3)
            faces.push_back({indices[i - 2], indices[i - 1], indices[i]});
    else
        for (std::size_t i = 2; i < indices.size(); ++i) {
            if (mode == mode_fan)
                faces.push_back({indices[0], indices[i - 1], indices[i]});
            else if (i % 2 == 0)
                faces.push_back({indices[i - 2], indices[i - 1], indices[i]});
            else
                faces.push_back({indices[i - 1], indices[i - 2], indices[i]});
        }
    return faces;
}

void read_uvs(GltfFile& file, const GltfValue& attributes, const GltfTextureUse& use, ColoredMesh& mesh) {
    const std::string name = fmt::format("TEXCOORD_{}", use.uv_set);
    const auto uvs = read_attribute(file, attributes, name, vec2_type, {}, mesh.positions.size());
    if (!uvs) {
        file.leave_out(fmt::format("textures on a mesh without {}", name));
        return;
    }
    for (std::size_t i = 0; i < uvs->count; ++i) {
        const glm::dvec2 uv = use({(*uvs)[i][0], (*uvs)[i][1]});
        mesh.uvs.emplace_back(uv.x, 1 - uv.y);  // glTF's v points down
    }
}

void read_colors(GltfFile& file, const GltfValue& attributes, ColoredMesh& mesh) {
    const auto colors =
        read_attribute(file, attributes, "COLOR_0", color_types, color_component_types, mesh.positions.size());
    if (!colors) return;
    for (std::size_t i = 0; i < colors->count; ++i) {
        const double* c = (*colors)[i];
        mesh.colors.push_back(glm::max(glm::vec3(float(c[0]), float(c[1]), float(c[2])), glm::vec3(0)));
    }
    if (std::all_of(mesh.colors.begin(), mesh.colors.end(), [](const glm::vec3& c) { return c == glm::vec3(1); }))
        mesh.colors.clear();
}

ColoredMesh read_vertices(GltfFile& file, const GltfValue& attributes, const GltfMaterial& material) {
    ColoredMesh mesh;
    const auto positions = read_attribute(file, attributes, "POSITION", vec3_type, {}, std::nullopt);
    for (std::size_t i = 0; i < positions->count; ++i) {
        const double* p = (*positions)[i];
        mesh.positions.emplace_back(p[0], p[1], p[2]);
    }
    if (const auto normals = read_attribute(file, attributes, "NORMAL", vec3_type, {}, positions->count))
        for (std::size_t i = 0; i < normals->count; ++i) {
            const double* n = (*normals)[i];
            mesh.normals.emplace_back(n[0], n[1], n[2]);
        }
    if (material.base_map) read_uvs(file, attributes, *material.base_map, mesh);
    return mesh;
}

/// The material of the primitive with its vertex colours, if it has any.
std::uint32_t colored_material(Loading& loading, GltfFile& file, GltfMaterials& materials, const GltfValue& attributes,
                               std::uint32_t index, ColoredMesh& mesh) {
    read_colors(file, attributes, mesh);
    if (mesh.colors.empty()) return index;
    const SceneMaterial& material = loading.scene.materials[index];
    if (material.diffuse_map || material.diffuse == glm::vec3(0)) {
        file.leave_out("vertex colours on textured and unlit meshes");
        return index;
    }
    for (const auto& [a, b, c] : mesh.triangles) mesh.corner_colors.push_back({a.position, b.position, c.position});
    const BakedColors baked = bake_colors(loading.scene, mesh, file.path());
    return materials.with_colors(index, baked.color, baked.image);
}

void append_primitive(Loading& loading, GltfFile& file, GltfMaterials& materials, const GltfValue& primitive,
                      const GltfTarget& target) {
    const std::uint64_t mode = primitive.whole_or("mode", mode_triangles);
    if (mode > mode_fan) primitive.at("mode").fail(fmt::format("is {}, but must be from 0 to 6", mode));
    if (mode < mode_triangles) return file.leave_out("points and lines");
    if (primitive.find("targets")) file.leave_out("morph targets");
    const GltfValue attributes = primitive.at("attributes");
    if (!attributes.find("POSITION")) return file.leave_out("primitives without POSITION");

    // A material of the scene file may have a texture: its coordinates are the first set, if there is one.
    GltfMaterial material{target.material.value_or(0), std::nullopt};
    const std::optional<GltfValue> own = primitive.find("material");
    if (target.material && attributes.find("TEXCOORD_0"))
        material.base_map = GltfTextureUse{};
    else if (!target.material && own)
        material = materials.use(own->whole());
    ColoredMesh mesh = read_vertices(file, attributes, material);
    const bool has_normals = !mesh.normals.empty(), has_uvs = !mesh.uvs.empty();
    const auto corner = [&](std::uint32_t i) { return Corner{i, has_normals ? i : NO_INDEX, has_uvs ? i : NO_INDEX}; };
    for (const auto& [a, b, c] : faces_of(read_indices(file, primitive, mesh.positions.size()), mode))
        mesh.triangles.push_back({corner(a), corner(b), corner(c)});
    if (target.smooth_angle) smooth_by_angle(mesh, *target.smooth_angle);
    if (!target.material) material.index = colored_material(loading, file, materials, attributes, material.index, mesh);
    append_mesh(loading.scene, mesh, target.transform, material.index, target.object);
}

}  // namespace

void append_gltf_mesh(Loading& loading, GltfFile& file, GltfMaterials& materials, const GltfValue& mesh,
                      const GltfTarget& target) {
    for (const GltfValue& primitive : mesh.at("primitives").items())
        append_primitive(loading, file, materials, primitive, target);
}

}  // namespace raymill
