#include "scene/toml_scene.hpp"

#include <fmt/format.h>

#include <cmath>

#include "scene/toml_reader.hpp"

namespace raymill {
namespace {

/// "light 2" or, with a name, "light 2 (\"lamp\")".
std::string subject_of(std::string_view section, std::size_t number, const toml::table& table) {
    const auto name = table["name"].value<std::string_view>();
    return name ? fmt::format("{} {} (\"{}\")", section, number, *name) : fmt::format("{} {}", section, number);
}

/// The [section] table, if there is one.
template <class Read>
void read_section(TableReader& root, std::string_view section, Read read) {
    const toml::table* table = root.table(section);
    if (!table) return;
    TableReader reader(root.loading(), root.file(), *table, std::string(section));
    read(reader);
    reader.finish();
}

/// Every [[section]] table, in order.
template <class Read>
void read_sections(TableReader& root, const toml::table& tables, std::string_view section, Read read) {
    if (!root.has(section)) return;
    const toml::array* array = tables.get(section)->as_array();
    if (!array) return root.error(section, fmt::format("must be written with double brackets: [[{}]]", section));
    for (std::size_t i = 0; i < array->size(); ++i) {
        const toml::table* table = array->get(i)->as_table();
        if (!table) {
            root.error_at(*array->get(i), fmt::format("{} {} must be a table", section, i + 1));
            continue;
        }
        TableReader reader(root.loading(), root.file(), *table, subject_of(section, i + 1, *table));
        read(reader);
        reader.finish();
    }
}

}  // namespace

void read_render(TableReader& reader, RenderSettings& settings) {
    double size[2] = {double(settings.width), double(settings.height)};
    if (reader.numbers("size", size, between(1, largest_side))) {
        if (size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]))
            reader.error("size", "must be whole numbers of pixels");
        settings.width = static_cast<int>(size[0]);
        settings.height = static_cast<int>(size[1]);
    }
    settings.spp = static_cast<int>(reader.integer("spp", settings.spp, 1, 1 << 20));
    settings.depth = static_cast<int>(reader.integer("depth", settings.depth, 0, 1000));
    settings.integrator = reader.choice("integrator", settings.integrator,
                                        {{"whitted", Integrator::whitted}, {"path", Integrator::path}});
    if (settings.integrator == Integrator::path)
        reader.error("integrator", "\"path\" is not in this version yet; use \"whitted\"");
    settings.background = glm::dvec3(reader.color("background", glm::vec3(settings.background)));
    settings.shadows =
        reader.choice("shadows", settings.shadows,
                      {{"filtered", ShadowMode::filtered}, {"opaque", ShadowMode::opaque}, {"none", ShadowMode::none}});
    settings.shadow_offset = reader.choice("shadow_offset", settings.shadow_offset,
                                           {{"robust", ShadowOffset::robust}, {"none", ShadowOffset::none}});
    settings.seed = static_cast<std::uint32_t>(reader.integer("seed", settings.seed, 0, 0xffffffff));
    settings.exposure = reader.number("exposure", settings.exposure, between(-100, 100));
    settings.min_weight = reader.number("min_weight", settings.min_weight, between(0, 1));
    double crop[4] = {0, 1, 0, 1};
    if (reader.numbers("crop", crop, between(0, 1))) {
        settings.crop = {crop[0], crop[1], crop[2], crop[3]};
        const PixelWindow window = crop_window(settings);
        if (window.width <= 0 || window.height <= 0)
            reader.error("crop", "holds no pixel: it is x0, x1, y0, y1 with x0 below x1 and y0 below y1");
    }
}

void read_camera(TableReader& reader, Camera& camera) {
    camera.projection =
        reader.choice("projection", camera.projection,
                      {{"perspective", Projection::perspective}, {"orthographic", Projection::orthographic}});
    camera.eye = reader.vector("eye", camera.eye);
    camera.look_at = reader.vector("look_at", camera.look_at);
    camera.up = reader.vector("up", camera.up);
    if (camera.projection == Projection::perspective)
        camera.fov = reader.number("fov", camera.fov, inside(0, 180));
    else
        camera.height = reader.number("height", camera.height, above(0));
    camera.aperture = reader.number("aperture", camera.aperture, at_least(0));
    camera.focus = reader.number("focus", camera.focus, above(0));

    const glm::dvec3 view = camera.look_at - camera.eye;
    const double length = glm::length(view), up_length = glm::length(camera.up);
    constexpr double least_sine = 1e-9;  // below it the horizon is decided by rounding
    if (!(length > 0))
        reader.error(reader.has("look_at") ? "look_at" : "eye", "must differ: look_at and eye are the same point");
    else if (!(up_length > 0))
        reader.error("up", "must not be zero");
    else if (!(glm::length(glm::cross(view / length, camera.up / up_length)) > least_sine))
        reader.error("up", "must not be parallel to the view from eye to look_at");
}

void read_toml_scene(Loading& loading, const std::string& text, const std::string& file) {
    toml::table tables;
    try {
        tables = toml::parse(text, file);
    } catch (const toml::parse_error& fault) {
        const toml::source_position& at = fault.source().begin;
        return loading.error({file, static_cast<int>(at.line), static_cast<int>(at.column)},
                             std::string(fault.description()));
    }
    Scene& scene = loading.scene;
    MaterialNames materials;
    TableReader root(loading, file, tables, "scene");
    read_section(root, "render", [&](TableReader& reader) { read_render(reader, scene.settings); });
    read_section(root, "camera", [&](TableReader& reader) { read_camera(reader, scene.camera); });
    read_sections(root, tables, "material", [&](TableReader& reader) { read_material(reader, materials); });
    read_sections(root, tables, "light", [&](TableReader& reader) { read_light(reader); });
    read_sections(root, tables, "object", [&](TableReader& reader) { read_object(reader, materials); });
    root.finish();
    if (scene.objects.empty() && loading.errors.empty())
        loading.warn({file}, "there are no objects: only the background and the lights that can be seen are rendered");
    add_light_geometry(scene);
}

}  // namespace raymill
