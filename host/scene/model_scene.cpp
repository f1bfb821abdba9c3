#include "scene/model_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

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

Box bounds_of(const std::vector<dvec3>& points) {
    Box box;
    for (const dvec3& p : points) {
        box.lower = glm::min(box.lower, p);
        box.upper = glm::max(box.upper, p);
    }
    return box;
}

/// Whether it shines more than it could reflect of the lights: a faint glow makes no lamp.
bool is_lamp(const Scene& scene, const Triangle& triangle) {
    const SceneMaterial& material = scene.materials[triangle.material];
    const glm::vec3 &e = material.emission, &d = material.diffuse;
    return std::max({e.r, e.g, e.b}) > std::max({d.r, d.g, d.b});
}

/// The corners of the triangles that are lamps, or of those that are not.
std::vector<dvec3> corners_of(const Scene& scene, bool lamps) {
    std::vector<dvec3> corners;
    for (const Triangle& triangle : scene.triangles) {
        const auto points = points_of(scene, triangle);
        if (is_lamp(scene, triangle) == lamps && finite(points))
            corners.insert(corners.end(), points.begin(), points.end());
    }
    return corners;
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

/// Corners of what stands between the six walls of a closed room of opaque walls; none if the model is no such room.
std::vector<dvec3> contents_of_closed_room(const Scene& scene, const Box& box, const std::vector<dvec3>& points) {
    const std::array<double, 6> covered = covered_sides(scene, box);
    constexpr double closed = 0.9;
    if (*std::min_element(covered.begin(), covered.end()) < closed) return {};
    for (const SceneMaterial& material : scene.materials)
        if (material.transmission > 0) return {};
    constexpr double wall = 0.05;  // of the box's size; what stands on the floor reaches above that
    std::vector<dvec3> contents;
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const double margin = wall * box.size()[axis];
            for (std::size_t k = i; k < i + 3; ++k)
                inside &= points[k][axis] > box.lower[axis] + margin && points[k][axis] < box.upper[axis] - margin;
        }
        if (inside) contents.insert(contents.end(), {points[i], points[i + 1], points[i + 2]});
    }
    return contents;
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
    explicit ViewAxes(const dvec3& towards_eye, const dvec3& upwards = {0, 1, 0})
        : right(glm::normalize(glm::cross(upwards, towards_eye))),
          up(glm::cross(towards_eye, right)),
          back(towards_eye) {}
};

/// The least distance from the centre at which all points are seen.
double framing_distance(const std::vector<dvec3>& points, const dvec3& center, const ViewAxes& view, double tan_x,
                        double tan_y) {
    double distance = 0;
    for (const dvec3& point : points) {
        const dvec3 p = point - center;
        const double forward = glm::dot(p, view.back);
        distance = std::max(distance, forward + std::abs(glm::dot(p, view.right)) / tan_x);
        distance = std::max(distance, forward + std::abs(glm::dot(p, view.up)) / tan_y);
    }
    return distance;
}

/// How far one can go from `start` within the box along the unit vector.
double way_inside(const Box& box, const dvec3& start, const dvec3& direction) {
    double way = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0) continue;
        const double wall = direction[axis] > 0 ? box.upper[axis] : box.lower[axis];
        way = std::min(way, (wall - start[axis]) / direction[axis]);
    }
    return way;
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

/// A colour, as one number where it is grey.
std::string toml_color(const glm::vec3& color) {
    return color.r == color.g && color.g == color.b ? toml_number(color.r) : toml_vector(color);
}

/// The lights that models have: those of glTF, and those made up here.
struct LightText {
    std::string operator()(const AmbientLight& light) const {
        return fmt::format("type = \"ambient\"\ncolor = {}\n", toml_color(light.color));
    }
    std::string operator()(const DirectionalLight& light) const {
        return fmt::format("type = \"directional\"\ndirection = {}\nintensity = {}\n", toml_vector(light.direction),
                           toml_color(light.intensity));
    }
    std::string operator()(const PointLight& light) const {
        const bool attenuated = light.attenuation != glm::vec3(1, 0, 0);
        return fmt::format("type = \"point\"\nposition = {}\nintensity = {}\n{}", toml_vector(light.position),
                           toml_color(light.intensity), attenuated ? attenuation(light.attenuation) : "");
    }
    std::string operator()(const SpotLight& light) const {
        return fmt::format(
            "type = \"spot\"\nposition = {}\ndirection = {}\nintensity = {}\n{}inner_angle = {}\nouter_angle = {}\n",
            toml_vector(light.position), toml_vector(light.direction), toml_color(light.intensity),
            attenuation(light.attenuation), toml_number(light.inner_angle), toml_number(light.outer_angle));
    }
    template <class Other>
    std::string operator()(const Other&) const {
        throw std::logic_error("no model has such a light");
    }
    static std::string attenuation(const glm::vec3& coefficients) {
        return fmt::format("attenuation = {}\n", toml_vector(coefficients));
    }
};

std::string camera_toml(const Camera& camera) {
    const bool orthographic = camera.projection == Projection::orthographic;
    return fmt::format("[camera]\n{}eye = {}\nlook_at = {}\nup = {}\n{} = {}\n\n",
                       orthographic ? "projection = \"orthographic\"\n" : "", toml_vector(camera.eye),
                       toml_vector(camera.look_at), toml_vector(camera.up), orthographic ? "height" : "fov",
                       toml_number(orthographic ? camera.height : camera.fov));
}

PointLight point_light(const dvec3& position, float intensity) {
    PointLight light;
    light.position = glm::vec3(rounded(position));
    light.intensity = glm::vec3(intensity);
    return light;
}

/// Below the lamps, or below the middle of the ceiling.
dvec3 room_light(const Scene& scene, const Box& room) {
    const Box lamps = bounds_of(corners_of(scene, true));
    const double below = 0.05 * room.size().y;
    dvec3 position(room.center().x, room.upper.y, room.center().z);
    if (!lamps.empty()) position = {lamps.center().x, std::min(lamps.lower.y, room.upper.y), lamps.center().z};
    position.y = std::max(position.y - below, room.lower.y + below);
    return position;
}

/// The largest light that reaches the point, as the sum over lights of what they shine there.
double light_at(const std::vector<SceneLight>& lights, const dvec3& point, double least_distance) {
    double sum = 0;
    const auto add = [&](const glm::vec3& intensity, double distance) {
        sum += std::max({intensity.r, intensity.g, intensity.b}) / (distance * distance);
    };
    for (const SceneLight& light : lights) {
        if (const auto* d = std::get_if<DirectionalLight>(&light.light)) add(d->intensity, 1);
        if (const auto* p = std::get_if<PointLight>(&light.light))
            add(p->intensity, std::max(glm::distance(dvec3(p->position), point), least_distance));
        if (const auto* s = std::get_if<SpotLight>(&light.light))
            add(s->intensity, std::max(glm::distance(dvec3(s->position), point), least_distance));
    }
    return sum;
}

/// The stops that show a white surface in the middle of the box at 0.8, to a tenth.
double exposure_for(const std::vector<SceneLight>& lights, const Box& box) {
    constexpr double shown_as = 0.8, nearest = 0.25;  // of the box's diagonal: a lamp may hang in its very middle
    const double light = light_at(lights, box.center(), nearest * glm::length(box.size()));
    if (!(light > 0 && std::isfinite(light))) return 0;
    return std::clamp(std::round(10 * std::log2(shown_as / light)) / 10, -100.0, 100.0);
}

AmbientLight ambient_light() {
    return {glm::vec3(0.1f)};
}

std::vector<SceneLight> room_lights(const Scene& scene, const Box& room, const dvec3& eye) {
    return {{point_light(room_light(scene, room), 0.7f)}, {point_light(eye, 0.3f)}, {ambient_light()}};
}

std::vector<SceneLight> studio_lights(const ViewAxes& view) {
    return {{light_from(-0.5 * view.right + 0.8 * view.up + 0.8 * view.back, 0.9f)},
            {light_from(0.8 * view.right + 0.2 * view.up + 0.6 * view.back, 0.3f)},
            {ambient_light()}};
}

}  // namespace

ModelFraming frame_model(const Scene& scene, const FileView& file) {
    ModelFraming framing;
    std::vector<dvec3> points = corners_of(scene, false);
    if (points.empty()) points = corners_of(scene, true);
    if (points.empty()) points = {dvec3(-1), dvec3(1)};
    if (glm::length(bounds_of(points).size()) == 0) points = {points[0] - 1.0, points[0] + 1.0};
    const Box box = bounds_of(points);
    const dvec3 open = open_side(scene, box);
    const bool is_open_room = open != dvec3(0);
    const std::vector<dvec3> contents = contents_of_closed_room(scene, box, points);
    const double turn = glm::radians(30.0), rise = glm::radians(20.0);
    const dvec3 corner_view(std::sin(turn) * std::cos(rise), std::sin(rise), std::cos(turn) * std::cos(rise));
    ViewAxes view(is_open_room ? open : corner_view);

    Camera& camera = framing.camera;
    if (file.camera) {
        camera = *file.camera;
        view = ViewAxes(glm::normalize(camera.eye - camera.look_at), camera.up);
    } else {
        constexpr double margin = 1.05, before_wall = 0.95;
        const RenderSettings settings;
        const double tan_y = std::tan(glm::radians(camera.fov / 2));
        const double tan_x = tan_y * settings.width / settings.height;
        const std::vector<dvec3>& framed = contents.empty() ? points : contents;
        const dvec3 center = bounds_of(framed).center();
        double distance = margin * framing_distance(framed, center, view, tan_x, tan_y);
        if (!contents.empty()) distance = std::min(distance, before_wall * way_inside(box, center, view.back));
        camera.look_at = rounded(center);
        camera.eye = rounded(center + distance * view.back);
        camera.up = {0, 1, 0};
    }

    if (!file.lights.empty()) {
        framing.lights = file.lights;
        framing.exposure = exposure_for(file.lights, box);
    } else if (is_open_room || !contents.empty()) {
        framing.lights = room_lights(scene, box, camera.eye);
    } else {
        framing.lights = studio_lights(view);
    }
    return framing;
}

namespace {

/// Appends the model's meshes and frames them; nothing where there are errors.
std::optional<ModelFraming> load_and_frame(Loading& loading, const std::string& file) {
    const FileView view = load_mesh_file(loading, file, {"mesh", std::nullopt, {}, std::nullopt}, {file});
    if (!loading.errors.empty()) return std::nullopt;
    return frame_model(loading.scene, view);
}

}  // namespace

void read_model(Loading& loading, const std::string& file) {
    std::optional<ModelFraming> framing = load_and_frame(loading, file);
    if (!framing) return;
    loading.scene.camera = framing->camera;
    loading.scene.lights = std::move(framing->lights);
    loading.scene.settings.exposure = framing->exposure;
}

std::string model_scene_toml(const std::string& model_file) {
    if (!is_mesh_file(model_file))
        throw SceneError({model_file},
                         fmt::format("a bare model ({}) is what a scene file is made for; a scene file is "
                                     "one already",
                                     mesh_extensions));
    Loading loading;
    loading.scene.materials.emplace_back();
    const std::optional<ModelFraming> framing = load_and_frame(loading, model_file);
    loading.finish(model_file);
    std::string text = "[render]\nsize = [640, 480]\n";
    if (framing->exposure != 0) text += fmt::format("exposure = {}\n", toml_number(framing->exposure));
    text += "\n";
    text += camera_toml(framing->camera);
    for (const SceneLight& light : framing->lights) text += "[[light]]\n" + std::visit(LightText{}, light.light) + "\n";
    text += fmt::format("[[object]]\nshape = \"mesh\"\nfile = {}\n", toml_text(model_file));
    return text;
}

}  // namespace raymill
