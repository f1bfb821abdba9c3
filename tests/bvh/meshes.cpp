#include "meshes.hpp"

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

namespace raymill::test {
namespace {

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float operator()(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) / static_cast<float>(1 << 24);
    }
    glm::vec3 in_cube(float low, float high) {
        const float x = (*this)(low, high), y = (*this)(low, high), z = (*this)(low, high);
        return {x, y, z};
    }

  private:
    std::mt19937 engine_;
};

Vertex vertex_at(const glm::vec3& p) {
    Vertex vertex{};
    for (int axis = 0; axis < 3; ++axis) vertex.position[axis] = p[axis];
    return vertex;
}

}  // namespace

void Mesh::add_triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const glm::vec3& p : {a, b, c}) vertices.push_back(vertex_at(p));
    triangles.push_back({{first, first + 1, first + 2}, 0, 0});
}

void Mesh::add_sphere(const glm::vec3& center, float radius) {
    spheres.push_back({{center.x, center.y, center.z}, radius, 0, 0});
}

Mesh random_soup(std::size_t count, std::uint32_t seed, float size) {
    Random random(seed);
    Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 center = random.in_cube(0, 1);
        const glm::vec3 a = random.in_cube(-size, size), b = random.in_cube(-size, size);
        mesh.add_triangle(center + a, center + b, center + random.in_cube(-size, size));
    }
    return mesh;
}

Mesh slivers(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 a = random.in_cube(0, 1), b = random.in_cube(0, 1);
        mesh.add_triangle(a, b, b + random.in_cube(-1e-6f, 1e-6f));
    }
    return mesh;
}

Mesh uneven_sheet(std::uint32_t side) {
    Mesh mesh;
    const auto place = [side](std::uint32_t i) {
        return std::pow(static_cast<float>(i) / static_cast<float>(side), 3.0f);
    };
    for (std::uint32_t y = 0; y <= side; ++y)
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float u = place(x), v = place(y);
            mesh.vertices.push_back(vertex_at({u, v, 0.1f * std::sin(20 * u) * std::cos(13 * v)}));
        }
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t i = y * (side + 1) + x, above = i + side + 1;
            mesh.triangles.push_back({{i, i + 1, above}, 0, 0});
            mesh.triangles.push_back({{i + 1, above + 1, above}, 0, 0});
        }
    return mesh;
}

Mesh random_spheres(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 center = random.in_cube(0, 1);
        mesh.add_sphere(center, random(0.001f, 0.05f));
    }
    return mesh;
}

Mesh concentric_triangles(std::size_t count) {
    Mesh mesh;
    for (std::size_t i = 1; i <= count; ++i) {
        const auto r = static_cast<float>(i);
        mesh.add_triangle({-r, -r, -r}, {r, -r, r}, {-r, r, r});
    }
    return mesh;
}

Mesh identical_triangles(std::size_t count) {
    Mesh mesh;
    mesh.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.triangles.resize(count, mesh.triangles.front());
    return mesh;
}

Mesh octaves() {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (int exponent = -120; exponent <= 120; ++exponent)
            for (const float fraction : {1.0f, 1.25f, 1.5f, 1.75f}) {
                const float x = std::ldexp(fraction, exponent), width = std::ldexp(1.0f, exponent - 6);
                glm::vec3 a{0}, b{0}, c{0};
                a[axis] = b[axis] = x;
                c[axis] = x + width;
                b[(axis + 1) % 3] = width;
                c[(axis + 2) % 3] = width;
                mesh.add_triangle(a, b, c);
            }
    return mesh;
}

std::optional<Mesh> read_obj(const std::string& file) {
    std::ifstream in(file);
    if (!in) return std::nullopt;
    Mesh mesh;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            glm::vec3 p;
            words >> p.x >> p.y >> p.z;
            mesh.vertices.push_back(vertex_at(p));
        } else if (word == "f") {
            std::vector<std::uint32_t> corners;
            while (words >> word) {
                const long index = std::stol(word);  // stops at the slash
                const long from_zero = index > 0 ? index - 1 : static_cast<long>(mesh.vertices.size()) + index;
                corners.push_back(static_cast<std::uint32_t>(from_zero));
            }
            for (std::size_t i = 2; i < corners.size(); ++i)
                mesh.triangles.push_back({{corners[0], corners[i - 1], corners[i]}, 0, 0});
        }
    }
    return mesh;
}

}  // namespace raymill::test
