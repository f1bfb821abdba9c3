#include "scenes.hpp"

#include <algorithm>
#include <cmath>

#include "mesh_parts.hpp"

namespace raymill::bench {

namespace {

BenchScene start(const char* name, const glm::dvec3& eye, const glm::dvec3& look_at, double fov, const Lamp& lamp) {
    BenchScene made{name, {}, lamp};
    made.scene.materials.emplace_back();
    made.scene.camera.eye = eye;
    made.scene.camera.look_at = look_at;
    made.scene.camera.fov = fov;
    return made;
}

/// A table or a chair: a slab on four legs. Parts keep a little apart: faces in one plane would tie.
void add_table(Scene& scene, const glm::vec3& at, const glm::vec3& size, double triangles) {
    const float leg = 0.06f * size.x, gap = 1e-3f;
    add_box(scene, at + glm::vec3(0, 0.92f * size.y, 0), at + size, triangles / 5);
    for (const float x : {0.0f, size.x - leg})
        for (const float z : {0.0f, size.z - leg})
            add_box(scene, at + glm::vec3(x + gap - 2 * gap * (x > 0), gap, z + gap - 2 * gap * (z > 0)),
                    at + glm::vec3(x + leg - gap, 0.92f * size.y - gap, z + leg - gap), triangles / 5);
}

/// A few large faces, more small ones, most of the triangles in turned ornaments: as rooms are modelled.
BenchScene interior(double triangles) {
    BenchScene made = start("interior", {-4.2, 1.7, 2.6}, {1.5, 0.9, -0.8}, 60, {{0.4f, 2.7f, 0.3f}, 0.6f, {0, -1, 0}});
    Scene& scene = made.scene;
    Random random(1);
    add_box(scene, {-5, 0, -3.5f}, {5, 3, 3.5f}, 0.05 * triangles);
    constexpr int tables = 16, vases_a_table = 4, columns = 10;
    for (int i = 0; i < tables; ++i) {
        const glm::vec3 size(random.uniform(0.5f, 1.1f), random.uniform(0.4f, 0.9f), random.uniform(0.5f, 0.8f));
        const glm::vec3 at(-4.4f + 2.2f * static_cast<float>(i % 4) + random.uniform(0, 0.6f), 0,
                           -3.0f + 1.6f * static_cast<float>(i / 4) + random.uniform(0, 0.4f));
        add_table(scene, at, size, 0.2 * triangles / tables);
        for (int k = 0; k < vases_a_table; ++k) {
            const float phase = random.uniform(0, 6);
            const glm::vec3 place =
                at + glm::vec3((k % 2 ? 0.75f : 0.25f) * size.x, size.y + 1e-3f, (k / 2 ? 0.75f : 0.25f) * size.z);
            const auto turned = [&](float h) { return 0.7f + 0.3f * std::sin(phase + 7 * h); };
            add_cylinder(scene, place, random.uniform(0.1f, 0.35f), 0.09f, turned,
                         0.55 * triangles / (tables * vases_a_table));
        }
    }
    for (int i = 0; i < columns; ++i) {
        const auto fluted = [](float h) { return 0.9f + 0.1f * std::cos(40 * h); };
        const glm::vec3 place(-4.5f + static_cast<float>(i), 1e-3f, i % 2 ? -3.25f : 3.25f);
        add_cylinder(scene, place, 2.9f, 0.12f, fluted, 0.2 * triangles / columns);
    }
    return made;
}

float rough_radius(const glm::vec3& direction) {
    return 1 + 0.25f * fractal_noise(2.0f * direction, 3) + 0.02f * fractal_noise(24.0f * direction, 4);
}

/// One closed surface of even triangles, as scanners give.
BenchScene scan(double triangles) {
    BenchScene made = start("scan", {1.2, 0.9, 3.0}, {0, 0, 0}, 38, {{2.5f, 4, 2}, 0.8f, {-0.5f, -0.78f, -0.38f}});
    add_globe(made.scene, glm::vec3(0), rough_radius, triangles);
    made.lamp.axis = glm::normalize(made.lamp.axis);
    return made;
}

/// Thousands of small objects over a floor, some inside each other.
BenchScene scattered(double triangles) {
    BenchScene made = start("scattered", {0, 9, 26}, {0, 2, 0}, 40, {{4, 20, 8}, 2, {0, -1, 0}});
    const int objects = std::clamp(static_cast<int>(triangles / 250), 50, 4000);
    const double each = 0.98 * triangles / objects;
    Random random(2);
    add_patch(made.scene, {-12, -0.5f, -12}, {0, 0, 24}, {24, 0, 0}, 0.02 * triangles);
    for (int i = 0; i < objects; ++i) {
        const glm::vec3 place = random.in_box({-10, 0.3f, -10}, {10, 8, 10});
        const float size = random.uniform(0.1f, 0.4f);
        if (i % 3 == 0)
            add_box(made.scene, place - size, place + size * glm::vec3(1, random.uniform(0.2f, 2), 1), each);
        else if (i % 3 == 1)
            add_cylinder(
                made.scene, place, 3 * size, 0.4f * size, [](float) { return 1.0f; }, each);
        else
            add_globe(
                made.scene, place, [&](const glm::vec3& d) { return size * (1 + 0.3f * noise(3.0f * d + place)); },
                each);
    }
    return made;
}

/// Blades 50 to 125 times as long as wide, in all directions: what boxes hold badly.
BenchScene thin(double triangles) {
    BenchScene made = start("thin", {0, 2, 7}, {0, 0, 0}, 36, {{3, 6, 4}, 0.8f, {0, -1, 0}});
    const auto blades = static_cast<int>(triangles);
    // The share of the volume that blades shade does not depend on their number.
    const float width = 1.5f / std::sqrt(static_cast<float>(blades));
    Random random(3);
    for (int i = 0; i < blades; ++i) {
        const glm::vec3 root = random.in_box(glm::vec3(-1.5f), glm::vec3(1.5f));
        const glm::vec3 along = random.direction();
        const glm::vec3 across = glm::normalize(glm::cross(along, random.direction()));
        const float wide = width * random.uniform(0.2f, 0.4f);
        add_triangle(made.scene, root - wide * across, root + wide * across,
                     root + 250 * wide * random.uniform(0.4f, 1) * along);
    }
    return made;
}

/// A dense statue in a hall of few triangles: most of the tree in a hundred-millionth of the volume.
BenchScene hall(double triangles) {
    BenchScene made = start("hall", {0.6, 1.5, 3.0}, {0, 1.0, 0}, 45, {{6, 14, 10}, 1.5f, {0, -1, 0}});
    Scene& scene = made.scene;
    add_box(scene, {-60, 0, -90}, {60, 30, 90}, 0.01 * triangles);
    for (int i = 0; i < 20; ++i)
        add_cylinder(
            scene, {i % 2 ? -30.0f : 30.0f, 1e-3f, -80.0f + 16.0f * static_cast<float>(i / 2)}, 29.9f, 1.2f,
            [](float) { return 1.0f; }, 0.03 * triangles / 20);
    add_box(scene, {-0.35f, 1e-3f, -0.35f}, {0.35f, 0.62f, 0.35f}, 0.01 * triangles);
    add_globe(
        scene, {0, 1.05f, 0}, [](const glm::vec3& d) { return 0.3f * rough_radius(d); }, 0.95 * triangles);
    return made;
}

BenchScene spheres(double triangles) {
    BenchScene made = start("spheres", {0, 4, 14}, {0, 0, 0}, 40, {{5, 12, 6}, 1.5f, {0, -1, 0}});
    const auto count = static_cast<int>(std::max(1.0, triangles / 10));
    const float size = 4 / std::cbrt(static_cast<float>(count));
    Random random(4);
    for (int i = 0; i < count; ++i) {
        const glm::vec3 c = random.in_box(glm::vec3(-4), glm::vec3(4));
        made.scene.spheres.push_back({{c.x, c.y, c.z}, size * random.uniform(0.2f, 0.8f), 0, 0});
    }
    return made;
}

/// Bounds of all triangles and spheres.
void grow(const Scene& scene, glm::vec3& lower, glm::vec3& upper) {
    const auto add = [&](const float(&p)[3], float radius) {
        lower = glm::min(lower, glm::vec3(p[0], p[1], p[2]) - radius);
        upper = glm::max(upper, glm::vec3(p[0], p[1], p[2]) + radius);
    };
    for (const Triangle& triangle : scene.triangles)
        for (const uint corner : triangle.vertex) add(scene.vertices[corner].position, 0);
    for (const Sphere& sphere : scene.spheres) add(sphere.center, sphere.radius);
}

}  // namespace

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all = {
        {"interior", "a room with furniture, turned ornaments and subdivided walls", interior},
        {"scan", "a closed displaced surface of even triangles", scan},
        {"scattered", "thousands of small objects over a floor", scattered},
        {"thin", "long thin triangles in all directions", thin},
        {"hall", "a small dense statue in a large sparse hall", hall},
        {"spheres", "spheres, a tenth as many as triangles elsewhere", spheres}};
    return all;
}

BenchScene load_bench_scene(const std::string& file) {
    BenchScene loaded{file, load_scene(file), {}};
    Scene& scene = loaded.scene;
    scene.planes.clear();
    glm::vec3 lower(INFINITY), upper(-INFINITY);
    grow(scene, lower, upper);
    const glm::vec3 center = 0.5f * (lower + upper);
    const float size = glm::length(upper - lower);
    loaded.lamp.position = 0.5f * (center + glm::vec3(scene.camera.eye)) + glm::vec3(0, 0.3f * (upper.y - lower.y), 0);
    for (const SceneLight& light : scene.lights)
        if (const auto* point = std::get_if<PointLight>(&light.light)) {
            loaded.lamp.position = point->position;
            break;
        }
    // Embree has neither filters nor skies.
    scene.settings.shadows = ShadowMode::opaque;
    scene.settings.background = glm::dvec3(0);
    scene.lights.clear();
    loaded.lamp.edge = 0.05f * size;
    const glm::vec3 axis = center - loaded.lamp.position;
    if (glm::length(axis) > 0) loaded.lamp.axis = glm::normalize(axis);
    return loaded;
}

}  // namespace raymill::bench
