#include "mesh_parts.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "lib/random.h"

namespace raymill::bench {

namespace {

Vertex vertex_at(const glm::vec3& p) {
    Vertex vertex{};
    for (int axis = 0; axis < 3; ++axis) vertex.position[axis] = p[axis];
    return vertex;
}

/// Columns of a square grid of about that many triangles.
int side(double triangles) {
    return std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / 2))));
}

float lattice(int x, int y, int z) {
    const std::uint32_t bits =
        hash4(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z), 0x6e6f6973u);
    return static_cast<float>(bits >> 8) * 0x1p-23f - 1;
}

}  // namespace

float Random::uniform() {
    return static_cast<float>(hash4(seed_, count_++, 0x62656e63u, 0) >> 8) * 0x1p-24f;
}

glm::vec3 Random::in_box(const glm::vec3& lower, const glm::vec3& upper) {
    const float x = uniform(), y = uniform(), z = uniform();
    return lower + (upper - lower) * glm::vec3(x, y, z);
}

glm::vec3 Random::direction() {
    const float height = uniform(-1, 1), angle = uniform(0, glm::two_pi<float>());
    const float wide = std::sqrt(1 - height * height);
    return {wide * std::cos(angle), height, wide * std::sin(angle)};
}

void add_grid(Scene& scene, int columns, int rows, const Surface& surface) {
    const auto first = static_cast<uint>(scene.vertices.size());
    const auto stride = static_cast<uint>(columns) + 1;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i)
            scene.vertices.push_back(vertex_at(surface(static_cast<float>(i) / static_cast<float>(columns),
                                                       static_cast<float>(j) / static_cast<float>(rows))));
    for (uint j = 0; j < static_cast<uint>(rows); ++j)
        for (uint i = 0; i < static_cast<uint>(columns); ++i) {
            const uint a = first + j * stride + i, b = a + 1, c = b + stride, d = a + stride;
            scene.triangles.push_back({{a, b, c}, 0, 0});
            scene.triangles.push_back({{a, c, d}, 0, 0});
        }
}

void add_patch(Scene& scene, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, double triangles) {
    const int n = side(triangles);
    add_grid(scene, n, n, [&](float s, float t) { return corner + s * u + t * v; });
}

void add_box(Scene& scene, const glm::vec3& lower, const glm::vec3& upper, double triangles) {
    const glm::vec3 size = upper - lower;
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 u(0), v(0), across(0);
        u[(axis + 1) % 3] = size[(axis + 1) % 3];
        v[(axis + 2) % 3] = size[(axis + 2) % 3];
        across[axis] = size[axis];
        add_patch(scene, lower, v, u, triangles / 6);
        add_patch(scene, lower + across, u, v, triangles / 6);
    }
}

void add_cylinder(Scene& scene, const glm::vec3& base, float height, float radius,
                  const std::function<float(float)>& profile, double triangles) {
    const auto ring = [&](float turn, float h, float scale) {
        const float angle = glm::two_pi<float>() * (turn == 1 ? 0 : turn);  // closed to the last bit
        const float r = radius * profile(h) * scale;
        return base + glm::vec3(r * std::cos(angle), h * height, r * std::sin(angle));
    };
    const int around = std::max(6, static_cast<int>(std::lround(std::sqrt(triangles))));
    const int rows = std::max(1, static_cast<int>(std::lround(triangles / around / 2)) - 2);
    add_grid(scene, around, rows, [&](float u, float v) { return ring(u, v, 1); });
    add_grid(scene, around, 1, [&](float u, float v) { return ring(u, 0, 1 - v); });
    add_grid(scene, around, 1, [&](float u, float v) { return ring(u, 1, v); });
}

void add_globe(Scene& scene, const glm::vec3& center, const std::function<float(const glm::vec3&)>& radius,
               double triangles) {
    const int n = side(triangles / 6);
    for (int axis = 0; axis < 3; ++axis)
        for (const float end : {-1.0f, 1.0f})
            add_grid(scene, n, n, [&](float u, float v) {
                glm::vec3 p(0);
                p[axis] = end;
                // Equal angles rather than equal lengths: triangles of nearly one size.
                p[(axis + 1) % 3] = std::tan(glm::quarter_pi<float>() * (2 * u - 1)) * end;
                p[(axis + 2) % 3] = std::tan(glm::quarter_pi<float>() * (2 * v - 1));
                p = glm::normalize(p);
                return center + radius(p) * p;
            });
}

void add_triangle(Scene& scene, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<uint>(scene.vertices.size());
    for (const glm::vec3& p : {a, b, c}) scene.vertices.push_back(vertex_at(p));
    scene.triangles.push_back({{first, first + 1, first + 2}, 0, 0});
}

float noise(const glm::vec3& p) {
    const glm::vec3 cell = glm::floor(p);
    const glm::vec3 f = p - cell;
    const glm::vec3 w = f * f * (3.0f - 2.0f * f);
    const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y), z = static_cast<int>(cell.z);
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        sum += (dx ? w.x : 1 - w.x) * (dy ? w.y : 1 - w.y) * (dz ? w.z : 1 - w.z) * lattice(x + dx, y + dy, z + dz);
    }
    return sum;
}

float fractal_noise(glm::vec3 p, int octaves) {
    float sum = 0, height = 1;
    for (int octave = 0; octave < octaves; ++octave) {
        sum += height * noise(p);
        p = 2.0f * p + 17.0f;
        height *= 0.5f;
    }
    return sum;
}

}  // namespace raymill::bench
