#include "probe.hpp"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "wavefront/records.hpp"

namespace raymill::truths {

namespace {

constexpr std::uint64_t small_queue = 1024;  // rays: the images are tiny, and queues are allocated for each probe

const Device& device() {
    static const Device opened = open_device("", 0);
    return opened;
}

RenderOptions small_queues() {
    RenderOptions options;
    options.memory.queue_capacity = small_queue;
    return options;
}

}  // namespace

Probe::Probe(Scene scene)
    : scene_(std::move(scene)),
      bvh_(build_bvh(scene_.vertices, scene_.triangles, scene_.spheres, {1})),
      renderer_(device(), scene_, bvh_, small_queues()) {}

void Probe::aim(const dvec3& eye, const dvec3& target) {
    scene_.camera.eye = eye;
    scene_.camera.look_at = target;
    const dvec3 along = glm::normalize(target - eye);
    scene_.camera.up = std::abs(along.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
}

Frame Probe::frame() {
    const CameraRecord camera = camera_record(scene_);
    device().queue.enqueueWriteBuffer(renderer_.device_scene().camera.memory(), CL_TRUE, 0, sizeof camera, &camera);
    Frame frame = renderer_.render();
    EXPECT_EQ(frame.not_a_number, 0u);
    EXPECT_EQ(frame.saturated, 0u);
    return frame;
}

dvec3 Probe::look(const dvec3& eye, const dvec3& target) {
    aim(eye, target);
    const Frame seen = frame();
    return {seen.rgba.at(0), seen.rgba.at(1), seen.rgba.at(2)};
}

dvec3 Probe::look_by_reference(const dvec3& eye, const dvec3& target) {
    aim(eye, target);
    return dvec3(reference::Tracer(scene_).pixel(0, 0));
}

dvec3 look(const Scene& scene, const dvec3& eye, const dvec3& target) {
    return Probe(scene).look(eye, target);
}

void expect_seen(Probe& probe, const dvec3& eye, const dvec3& target, const dvec3& expected, double bound) {
    const dvec3 kernels = probe.look(eye, target);
    const dvec3 scalar = probe.look_by_reference(eye, target);
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(kernels[channel], expected[channel], bound) << "kernels, channel " << channel;
        EXPECT_NEAR(scalar[channel], expected[channel], bound) << "reference, channel " << channel;
    }
}

Estimate estimate(Probe& probe, const dvec3& eye, const dvec3& target, int seeds) {
    dvec3 sum(0), squares(0);
    for (int seed = 0; seed < seeds; ++seed) {
        probe.scene().settings.seed = static_cast<std::uint32_t>(seed);
        const dvec3 seen = probe.look(eye, target);
        sum += seen;
        squares += seen * seen;
    }
    Estimate e;
    e.mean = sum / static_cast<double>(seeds);
    const dvec3 variance = glm::max(squares / static_cast<double>(seeds) - e.mean * e.mean, dvec3(0));
    e.error = glm::sqrt(variance / static_cast<double>(seeds - 1));
    return e;
}

void expect_estimate(const Estimate& estimate, double expected) {
    EXPECT_NEAR(estimate.mean.x, expected, 4 * estimate.error.x + hit_roundings * expected);
    EXPECT_LT(estimate.error.x, 0.02 * expected);
}

double find_edge(double inside, double outside, const std::function<bool(double)>& is_inside, int steps) {
    EXPECT_TRUE(is_inside(inside));
    EXPECT_FALSE(is_inside(outside));
    for (int step = 0; step < steps; ++step) {
        const double middle = 0.5 * (inside + outside);
        (is_inside(middle) ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
}

void add_ruler(SceneBuilder& builder, const glm::vec3& corner, const glm::vec3& edge_x, const glm::vec3& edge_y) {
    Scene& scene = builder.scene;
    // Between the centres of its four texels, at a quarter and three quarters, a texture is linear.
    TextureImage image;
    image.width = image.height = 2;
    image.texels = {{0, 1, 1}, {1, 1, 1}, {0, 0, 1}, {1, 0, 1}};
    scene.images.push_back(image);
    SceneMaterial material = white();
    material.diffuse_map = static_cast<std::uint32_t>(scene.images.size() - 1);
    const std::uint32_t id = builder.add_material(material);
    const glm::vec3 b = corner + edge_x, c = corner + edge_x + edge_y, d = corner + edge_y;
    const glm::vec2 low(0.25f), high(0.75f);
    builder.add_triangle({corner, b, c}, id, {}, {low, glm::vec2(high.x, low.y), high});
    builder.add_triangle({corner, c, d}, id, {}, {low, high, glm::vec2(low.x, high.y)});
    DirectionalLight light;
    light.direction = -glm::cross(edge_x, edge_y);
    builder.add_light(light);
    scene.settings.shadows = ShadowMode::none;
}

Scene scene_of(const std::string& toml) {
    const std::string name = "raymill-truth-" + std::to_string(getpid()) + ".toml";  // tests may run side by side
    const std::filesystem::path file = std::filesystem::temp_directory_path() / name;
    std::ofstream(file) << toml;
    Scene scene = load_scene(file.string());
    std::filesystem::remove(file);
    return scene;
}

}  // namespace raymill::truths
