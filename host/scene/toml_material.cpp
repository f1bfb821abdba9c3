#include <fmt/format.h>

#include "scene/texture.hpp"
#include "scene/toml_reader.hpp"
#include "scene/toml_scene.hpp"

namespace raymill {
namespace {

void read_checker(TableReader& reader, SceneMaterial& material) {
    const toml::table* table = reader.table("diffuse_checker");
    if (!table) return;
    TableReader checker_reader(reader.loading(), reader.file(), *table, reader.subject() + ": diffuse_checker");
    Checker checker;
    checker.a = checker_reader.color("a", checker.a);
    checker.b = checker_reader.color("b", checker.b);
    checker.scale = checker_reader.real("scale", checker.scale, above(0));
    checker_reader.finish();
    material.diffuse_checker = checker;
}

void read_diffuse(TableReader& reader, SceneMaterial& material) {
    material.diffuse = reader.color("diffuse", material.diffuse);
    read_checker(reader, material);
    const std::string map = reader.text("diffuse_map");
    if (map.empty()) return;
    if (material.diffuse_checker) return reader.error("diffuse_map", "cannot go together with diffuse_checker");
    const SourcePosition named_at = reader.position_of("diffuse_map");
    material.diffuse_map = load_texture(reader.loading(), path_beside(reader.file(), map), named_at, false);
    // A picture alone is shown as it is, not darkened by the default.
    if (!reader.has("diffuse")) material.diffuse = glm::vec3(1);
}

}  // namespace

void read_material(TableReader& reader, MaterialNames& names) {
    SceneMaterial material;
    reader.require({"name"});
    material.name = reader.text("name");
    material.ambient = reader.color("ambient", material.ambient);
    read_diffuse(reader, material);
    material.specular = reader.color("specular", material.specular);
    material.shininess = reader.real("shininess", material.shininess, at_least(0));
    material.highlight =
        reader.choice("highlight", material.highlight, {{"phong", Highlight::phong}, {"blinn", Highlight::blinn}});
    material.shading =
        reader.choice("shading", material.shading,
                      {{"flat", Shading::flat}, {"gouraud", Shading::gouraud}, {"phong", Shading::phong}});
    material.emission = reader.color("emission", material.emission);
    const double reflection = reader.number("reflection", 0, between(0, 1));
    const double transmission = reader.number("transmission", 0, between(0, 1));
    constexpr double rounding = 1e-9;  // of decimal fractions that sum to 1 on paper
    if (reflection + transmission > 1 + rounding)
        reader.error(reader.has("transmission") ? "transmission" : "reflection",
                     fmt::format("and reflection must sum to at most 1, not {}", reflection + transmission));
    material.reflection = static_cast<float>(reflection);
    material.transmission = std::min(static_cast<float>(transmission), 1 - material.reflection);
    material.base_color = reader.color("base_color", material.base_color);
    material.ior = reader.real("ior", material.ior, above(0));
    material.exterior_ior = reader.real("exterior_ior", material.exterior_ior, above(0));
    material.fresnel = reader.boolean("fresnel", material.fresnel);
    material.absorption = reader.color("absorption", material.absorption);

    Scene& scene = reader.loading().scene;
    const auto [entry, is_new] = names.try_emplace(material.name, static_cast<std::uint32_t>(scene.materials.size()));
    if (!is_new && !material.name.empty())
        reader.error("name", fmt::format("\"{}\" is already taken by another material", material.name));
    scene.materials.push_back(std::move(material));
}

}  // namespace raymill
