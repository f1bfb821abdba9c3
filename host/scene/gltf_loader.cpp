#include "scene/gltf_loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scene/gltf_mesh.hpp"

namespace raymill {
namespace {

glm::dmat4 matrix_of(const GltfValue& value) {
    const std::vector<double> v = value.numbers(16);
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = v[static_cast<std::size_t>(i)];
    if (v[3] != 0 || v[7] != 0 || v[11] != 0 || v[15] != 1) value.fail("must be affine: its last row 0, 0, 0, 1");
    return matrix;
}

glm::dvec3 vector_or(const GltfValue& node, const std::string& key, const glm::dvec3& otherwise) {
    const std::optional<GltfValue> found = node.find(key);
    if (!found) return otherwise;
    const std::vector<double> v = found->numbers(3);
    return {v[0], v[1], v[2]};
}

glm::dmat4 transform_of(const GltfValue& node) {
    if (const auto matrix = node.find("matrix")) {
        for (const char* key : {"translation", "rotation", "scale"})
            if (node.find(key)) matrix->fail(fmt::format("must not stand beside \"{}\"", key));
        return matrix_of(*matrix);
    }
    glm::dquat rotation(1, 0, 0, 0);
    if (const auto found = node.find("rotation")) {
        const std::vector<double> v = found->numbers(4);
        rotation = glm::dquat(v[3], v[0], v[1], v[2]);
        const double length = glm::length(rotation);
        if (!(length > 0 && std::isfinite(length))) found->fail("must be a quaternion of length 1");
        rotation /= length;
    }
    glm::dmat4 matrix = glm::translate(glm::dmat4(1), vector_or(node, "translation", glm::dvec3(0)));
    if (rotation != glm::dquat(1, 0, 0, 0)) matrix *= glm::mat4_cast(rotation);
    return glm::scale(matrix, vector_or(node, "scale", glm::dvec3(1)));
}

/// The camera at the node: it looks along -z, up is +y.
Camera camera_at(const GltfValue& value, const glm::dmat4& world) {
    Camera camera;
    const std::string type = value.at("type").text();
    if (type == "perspective") {
        camera.fov = glm::degrees(value.at("perspective").at("yfov").number(0));
    } else if (type == "orthographic") {
        const GltfValue height = value.at("orthographic").at("ymag");
        camera.projection = Projection::orthographic;
        camera.height = 2 * std::abs(height.number());
        if (!(camera.height > 0)) height.fail("must not be 0");
    } else {
        value.at("type").fail(fmt::format("is \"{}\", but must be \"perspective\" or \"orthographic\"", type));
    }
    camera.eye = glm::dvec3(world[3]);
    camera.look_at = camera.eye - glm::normalize(glm::dvec3(world[2]));
    camera.up = glm::normalize(glm::dvec3(world[1]));
    const glm::dvec3 horizon = glm::cross(camera.up, camera.look_at - camera.eye);
    constexpr double least_sine = 1e-9;  // as for cameras of scene files
    if (!(glm::length(horizon) > least_sine)) value.fail("stands at a node that squeezes it flat");
    return camera;
}

glm::vec3 intensity_of(const GltfValue& light) {
    const double intensity = light.number_or("intensity", 1, 0, gltf_infinity) / glm::pi<double>();
    glm::dvec3 color(1);
    if (const auto found = light.find("color")) {
        const std::vector<double> v = found->numbers(3, 0);
        color = {v[0], v[1], v[2]};
    }
    const glm::vec3 result(intensity * color);
    if (!std::isfinite(result.x + result.y + result.z)) light.fail("has an intensity beyond 32-bit floats");
    return result;
}

SpotLight spot_at(const GltfValue& light, const glm::dmat4& world) {
    SpotLight spot;
    spot.position = glm::vec3(world[3]);
    spot.direction = glm::vec3(-glm::normalize(glm::dvec3(world[2])));
    spot.intensity = intensity_of(light);
    spot.attenuation = {0, 0, 1};
    const GltfValue cone = light.at("spot");
    const double outer = cone.number_or("outerConeAngle", glm::quarter_pi<double>(), 0, glm::half_pi<double>());
    const double inner = cone.number_or("innerConeAngle", 0, 0, glm::half_pi<double>());
    if (!(inner < outer)) cone.fail("must have an innerConeAngle below its outerConeAngle");
    spot.outer_angle = std::min(static_cast<float>(glm::degrees(outer)), 90.0f);
    spot.inner_angle = std::min(static_cast<float>(glm::degrees(inner)), spot.outer_angle);
    return spot;
}

SceneLight light_at(const GltfValue& light, const glm::dmat4& world) {
    const std::string type = light.at("type").text();
    if (type == "directional")
        return {DirectionalLight{glm::vec3(-glm::normalize(glm::dvec3(world[2]))), intensity_of(light)}};
    if (type == "point") return {PointLight{glm::vec3(world[3]), intensity_of(light), glm::vec3(0, 0, 1), 0}};
    if (type != "spot") light.at("type").fail(fmt::format("is \"{}\", but must be directional, point or spot", type));
    return {spot_at(light, world)};
}

class Loader {
  public:
    Loader(Loading& loading, GltfFile& file, const MeshPlacement& placement)
        : loading_(loading), file_(file), placement_(placement), materials_(loading, file) {}

    FileView load() {
        const GltfValue root = file_.root();
        for (const char* key : {"animations", "skins"})
            if (const auto found = root.find(key); found && !found->items().empty()) file_.leave_out(key);
        check_unused();
        struct Entry {
            std::uint64_t node;
            glm::dmat4 parent;
        };
        std::vector<Entry> stack;
        for (const std::uint64_t node : roots()) stack.push_back({node, glm::dmat4(1)});
        std::reverse(stack.begin(), stack.end());
        while (!stack.empty()) {
            const auto [index, parent] = stack.back();
            stack.pop_back();
            const GltfValue node = root.at("nodes").item(index);
            const glm::dmat4 world = parent * transform_of(node);
            add_node(node, world);
            const auto children = node.find("children");
            if (!children) continue;
            const std::size_t first = stack.size();
            for (const GltfValue& child : children->items()) stack.push_back({child.whole(), world});
            std::reverse(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end());
        }
        return std::move(view_);
    }

  private:
    /// The root nodes of the scene that is shown.
    std::vector<std::uint64_t> roots() const {
        const GltfValue root = file_.root();
        std::vector<std::uint64_t> nodes;
        const auto scenes = root.find("scenes"), number = root.find("scene"), all = root.find("nodes");
        if (scenes && !scenes->items().empty()) {
            const GltfValue scene = scenes->item(number ? number->whole() : 0);
            if (const auto listed = scene.find("nodes"))
                for (const GltfValue& node : listed->items()) nodes.push_back(node.whole());
            return nodes;
        }
        const std::size_t count = all ? all->items().size() : 0;
        std::vector<bool> is_child(count, false);
        for (std::size_t i = 0; i < count; ++i)
            if (const auto children = all->item(i).find("children"))
                for (const GltfValue& child : children->items()) is_child[child.whole()] = true;
        for (std::size_t i = 0; i < count; ++i)
            if (!is_child[i]) nodes.push_back(i);
        return nodes;
    }

    /// Faults of cameras, lights and materials are found also where no node shows them.
    void check_unused() {
        const GltfValue root = file_.root();
        if (const auto cameras = root.find("cameras"))
            for (const GltfValue& camera : cameras->items()) camera_at(camera, glm::dmat4(1));
        if (const auto lights = root.extension("KHR_lights_punctual"))
            for (const GltfValue& light : lights->at("lights").items()) light_at(light, glm::dmat4(1));
        if (const auto images = root.find("images"))
            for (const GltfValue& image : images->items()) file_.picture(image);
        const auto materials = root.find("materials");
        if (!materials || placement_.material) return;
        for (std::size_t i = 0; i < materials->items().size(); ++i) materials_.use(i);
    }

    void add_node(const GltfValue& node, const glm::dmat4& world) {
        if (const auto reference = node.find("mesh")) add_mesh(node, file_.referred(*reference, "meshes"), world);
        if (const auto reference = node.find("camera")) {
            const Camera camera = camera_at(file_.referred(*reference, "cameras"), world);
            if (!(camera.fov > 0 && camera.fov < 180)) reference->fail("has a yfov that is not above 0 and below pi");
            if (!view_.camera) view_.camera = camera;
        }
        if (const auto reference = node.extension("KHR_lights_punctual")) {
            const GltfValue lights = file_.root().at("extensions").at("KHR_lights_punctual").at("lights");
            view_.lights.push_back(light_at(lights.item(reference->at("light").whole()), world));
        }
    }

    void add_mesh(const GltfValue& node, const GltfValue& mesh, const glm::dmat4& world) {
        Scene& scene = loading_.scene;
        const std::string name = node.text_or("name", mesh.text_or("name", ""));
        scene.objects.push_back({name.empty() ? placement_.name : name, "mesh", 0});
        const auto object = static_cast<std::uint32_t>(scene.objects.size() - 1);
        append_gltf_mesh(loading_, file_, materials_, mesh,
                         {placement_.transform.after(world), object, placement_.material, placement_.smooth_angle});
    }

    Loading& loading_;
    GltfFile& file_;
    const MeshPlacement& placement_;
    GltfMaterials materials_;
    FileView view_;
};

}  // namespace

FileView load_gltf(Loading& loading, const std::string& path, const MeshPlacement& placement,
                   const SourcePosition& named_at) {
    std::string reason;
    std::optional<std::string> bytes = loading.files.read(path, reason);
    if (!bytes) {
        loading.error(named_at, fmt::format("cannot read the mesh \"{}\": {}", path, reason));
        return {};
    }
    const std::size_t triangles = loading.scene.triangles.size();
    try {
        GltfFile file(loading, path, std::move(*bytes));
        FileView view = Loader(loading, file, placement).load();
        file.warn_of_left_out();
        if (loading.scene.triangles.size() == triangles) loading.warn({path}, "there are no faces in this file");
        return view;
    } catch (const SceneError& error) {
        loading.errors.insert(loading.errors.end(), error.diagnostics().begin(), error.diagnostics().end());
        return {};
    }
}

}  // namespace raymill
