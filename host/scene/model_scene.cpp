#include "scene/model_scene.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "scene/obj_loader.hpp"

namespace raymill {
namespace {

using glm::dvec3;

struct Box {
    dvec3 lower{INFINITY};
    dvec3 upper{-INFINITY};
    dvec3 center() const { return 0.5 * (lower + upper); }
    dvec3 size() const { return upper - lower; }
    bool empty() const { return !(lower.x <= upper.x); }
};

std::array<dvec3, 3> points_of(const Scene& scene, const Triangle& triangle) {
    std::array<dvec3, 3> points;
    for (int i = 0; i < 3; ++i) {
        const float* p = scene.vertices[triangle.vertex[i]].position;
        points[i] = {p[0], p[1], p[2]};
    }
    return points;
}

bool finite(const std::array<dvec3, 3>& points) {
    double sum = 0;
    for (const dvec3& p : points) sum += std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
    return std::isfinite(sum);
}

Box bounds_of(const Scene& scene) {
    Box box;
    for (const Triangle& triangle : scene.triangles) {
        const auto points = points_of(scene, triangle);
        if (!finite(points)) continue;
        for (const dvec3& p : points) {
            box.lower = glm::min(box.lower, p);
            box.upper = glm::max(box.upper, p);
        }
    }
    return box;
}

/// How much of each side of the box is covered by triangles close to it: side 2 * axis is the lower, + 1 the upper.
std::array<double, 6> covered_sides(const Scene& scene, const Box& box) {
    constexpr double close = 0.05;  // of the box's size: walls of real models are not quite straight
    std::array<double, 6> covered{};
    for (const Triangle& triangle : scene.triangles) {
        const auto p = points_of(scene, triangle);
        if (!finite(p)) continue;
        const dvec3 doubled_area = glm::abs(glm::cross(p[1] - p[0], p[2] - p[0]));
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side) {
                const double wall = side ? box.upper[axis] : box.lower[axis], margin = close * box.size()[axis];
                bool lies_in_wall = true;
                for (const dvec3& point : p) lies_in_wall &= std::abs(point[axis] - wall) <= margin;
                if (lies_in_wall) covered[2 * axis + side] += 0.5 * doubled_area[axis];
            }
    }
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            covered[2 * axis + side] /= box.size()[(axis + 1) % 3] * box.size()[(axis + 2) % 3];
    return covered;
}

/// The direction out of a room's one open side, or zero if the model is no room.
dvec3 open_side(const Scene& scene, const Box& box) {
    if (!(box.size().x > 0 && box.size().y > 0 && box.size().z > 0)) return dvec3(0);
    const std::array<double, 6> covered = covered_sides(scene, box);
    constexpr double closed = 0.5;
    for (const int side : {5, 4, 1, 0}) {
        bool room = covered[side] < closed;
        for (int other = 0; other < 6; ++other) room &= other == side || covered[other] >= closed;
        dvec3 out(0);
        out[side / 2] = side % 2 ? 1 : -1;
        if (room) return out;
    }
    return dvec3(0);
}

/// To six significant digits.
double rounded(double value) {
    return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr);
}
dvec3 rounded(const dvec3& v) {
    return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

struct ViewAxes {
    dvec3 right, up, back;  // back points from the model to the eye
    explicit ViewAxes(const dvec3& towards_eye)
        : right(glm::normalize(glm::cross(dvec3(0, 1, 0), towards_eye))),
          up(glm::cross(towards_eye, right)),
          back(towards_eye) {}
};

/// The least distance from the box's centre at which all its corners are seen.
double framing_distance(const Box& box, const ViewAxes& view, double tan_x, double tan_y) {
    double distance = 0;
    for (int i = 0; i < 8; ++i) {
        const dvec3 signs((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
        const dvec3 corner = 0.5 * signs * box.size();
        const double forward = glm::dot(corner, view.back);
        distance = std::max(distance, forward + std::abs(glm::dot(corner, view.right)) / tan_x);
        distance = std::max(distance, forward + std::abs(glm::dot(corner, view.up)) / tan_y);
    }
    return distance;
}

/// A light that travels against `towards_light`.
DirectionalLight light_from(const dvec3& towards_light, float intensity) {
    return {glm::vec3(glm::normalize(rounded(-glm::normalize(towards_light)))), glm::vec3(intensity)};
}

/// With few digits, and always with what tells a number from a whole one.
std::string toml_number(double value) {
    const std::string text = fmt::format("{}", value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

template <class V>
std::string toml_vector(const V& v) {
    return fmt::format("[{}, {}, {}]", toml_number(v.x), toml_number(v.y), toml_number(v.z));
}

/// A basic TOML string.
std::string toml_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            quoted += {'\\', c};
        else if (code < 0x20 || code == 0x7f)
            quoted += fmt::format("\\u{:04X}", code);
        else
            quoted += c;
    }
    return quoted + '"';
}

std::string light_toml(const DirectionalLight& light) {
    return fmt::format("[[light]]\ntype = \"directional\"\ndirection = {}\nintensity = {}\n\n",
                       toml_vector(light.direction), toml_number(light.intensity.x));
}

}  // namespace

ModelFraming frame_model(const Scene& scene) {
    ModelFraming framing;
    Box box = bounds_of(scene);
    if (box.empty()) box = {dvec3(-1), dvec3(1)};
    if (glm::length(box.size()) == 0) {
        box.lower -= 1.0;
        box.upper += 1.0;
    }
    const dvec3 open = open_side(scene, box);
    const bool room = open != dvec3(0);
    const double turn = glm::radians(30.0), rise = glm::radians(20.0);
    const dvec3 corner_view(std::sin(turn) * std::cos(rise), std::sin(rise), std::cos(turn) * std::cos(rise));
    const ViewAxes view(room ? open : corner_view);

    Camera& camera = framing.camera;
    constexpr double margin = 1.05;
    const RenderSettings settings;
    const double tan_y = std::tan(glm::radians(camera.fov / 2));
    const double tan_x = tan_y * settings.width / settings.height;
    camera.look_at = rounded(box.center());
    camera.eye = rounded(box.center() + margin * framing_distance(box, view, tan_x, tan_y) * view.back);
    camera.up = {0, 1, 0};

    if (room) {  // nearly level, or the ceiling would keep the light out
        framing.key = light_from(-0.25 * view.right + 0.15 * view.up + view.back, 0.7f);
        framing.fill = light_from(0.25 * view.right - 0.05 * view.up + view.back, 0.35f);
    } else {
        framing.key = light_from(-0.5 * view.right + 0.8 * view.up + 0.8 * view.back, 0.9f);
        framing.fill = light_from(0.8 * view.right + 0.2 * view.up + 0.6 * view.back, 0.3f);
    }
    framing.ambient.color = glm::vec3(0.1f);
    return framing;
}

void read_model(Loading& loading, const std::string& file) {
    Scene& scene = loading.scene;
    load_obj(loading, file, {"mesh", std::nullopt, {}, std::nullopt}, {file});
    if (!loading.errors.empty()) return;
    const ModelFraming framing = frame_model(scene);
    scene.camera = framing.camera;
    scene.lights = {{framing.key}, {framing.fill}, {framing.ambient}};
}

std::string model_scene_toml(const std::string& model_file) {
    if (extension_of(model_file) != ".obj")
        throw SceneError({model_file},
                         "a bare model (.obj) is what a scene file is made for; a scene file is one already");
    Loading loading;
    loading.scene.materials.emplace_back();
    read_model(loading, model_file);
    loading.finish(model_file);
    const ModelFraming framing = frame_model(loading.scene);
    const Camera& camera = framing.camera;
    std::string text = "[render]\nsize = [640, 480]\n\n";
    text += fmt::format("[camera]\neye = {}\nlook_at = {}\nup = {}\nfov = {}\n\n", toml_vector(camera.eye),
                        toml_vector(camera.look_at), toml_vector(camera.up), toml_number(camera.fov));
    text += light_toml(framing.key) + light_toml(framing.fill);
    text += fmt::format("[[light]]\ntype = \"ambient\"\ncolor = {}\n\n", toml_number(framing.ambient.color.x));
    text += fmt::format("[[object]]\nshape = \"mesh\"\nfile = {}\n", toml_text(model_file));
    return text;
}

}  // namespace raymill
