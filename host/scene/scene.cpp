#include "scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "scene/loading.hpp"
#include "scene/mesh_file.hpp"
#include "scene/model_scene.hpp"
#include "scene/toml_scene.hpp"

namespace raymill {
namespace {

void read_scene_file(Loading& loading, const std::string& file) {
    const std::string extension = extension_of(file);
    if (is_mesh_file(file)) return read_model(loading, file);
    if (extension != ".toml")
        return loading.error({file}, fmt::format("a scene file (.toml) or a model ({}) is what is read, not \"{}\"",
                                                 mesh_extensions, extension.empty() ? "no extension" : extension));
    std::string reason;
    const std::optional<std::string> text = loading.files.read(file, reason);
    if (!text) return loading.error({file}, fmt::format("cannot read the scene file: {}", reason));
    read_toml_scene(loading, *text, file);
}

}  // namespace

PixelWindow crop_window(const RenderSettings& settings) {
    const auto edge = [](double fraction, int size) {
        return std::clamp(static_cast<int>(std::ceil(fraction * size)), 0, size);
    };
    const Crop& crop = settings.crop;
    const int x0 = edge(crop.x0, settings.width), x1 = edge(crop.x1, settings.width);
    const int y0 = edge(crop.y0, settings.height), y1 = edge(crop.y1, settings.height);
    return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

Scene load_scene(const std::string& file) {
    Loading loading;
    loading.scene.file = file;
    loading.scene.materials.emplace_back();
    try {
        read_scene_file(loading, file);
    } catch (const std::bad_alloc&) {
        loading.error({file}, "there is not enough memory to load this scene");
    }
    loading.finish(file);
    loading.scene.hash = loading.files.hash();
    return std::move(loading.scene);
}

}  // namespace raymill
