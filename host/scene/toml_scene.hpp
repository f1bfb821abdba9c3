// Scene files: TOML with the keys of docs/scene-file.md.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scene/loading.hpp"

namespace raymill {

class TableReader;

/// Reads a scene file's text into loading.scene; faults go to loading.errors. `file` names it in messages, and
/// paths in it are relative to its folder.
void read_toml_scene(Loading& loading, const std::string& text, const std::string& file);

using MaterialNames = std::map<std::string, std::uint32_t>;

// The sections, one table each. `number` counts from 1 in the file.
void read_render(TableReader& reader, RenderSettings& settings);
void read_camera(TableReader& reader, Camera& camera);
/// Appends the material and enters its name.
void read_material(TableReader& reader, MaterialNames& names);
void read_light(TableReader& reader);
void read_object(TableReader& reader, const MaterialNames& materials);

/// Gives visible rectangle, disk and sphere lights geometry that shines: an object, and a material of its own (black
/// but for its emission, which on rectangles and disks is one-sided).
void add_light_geometry(Scene& scene);

}  // namespace raymill
