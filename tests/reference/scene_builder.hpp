// Small scenes for the tests, part by part.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "reference/reference.hpp"
#include "scene/scene.hpp"

namespace raymill::reference {

inline void copy(const glm::vec3& from, float (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

/// A scene with the default material and a one-pixel image; every add_ function returns the new part's index.
struct SceneBuilder {
    Scene scene;

    SceneBuilder() {
        scene.materials.emplace_back();
        scene.settings.width = scene.settings.height = 1;
    }

    std::uint32_t add_material(const SceneMaterial& material) {
        scene.materials.push_back(material);
        return static_cast<std::uint32_t>(scene.materials.size() - 1);
    }

    template <typename Light>
    std::uint32_t add_light(const Light& light, std::uint32_t samples = 1) {
        SceneLight source;
        source.light = light;
        source.samples = samples;
        scene.lights.push_back(source);
        return static_cast<std::uint32_t>(scene.lights.size() - 1);
    }

    std::uint32_t add_triangle(const std::array<glm::vec3, 3>& points, std::uint32_t material = 0,
                               const std::array<glm::vec3, 3>& normals = {}, const std::array<glm::vec2, 3>& uvs = {}) {
        Triangle triangle{};
        triangle.material = material;
        for (int i = 0; i < 3; ++i) {
            Vertex vertex{};
            copy(points[i], vertex.position);
            copy(normals[i], vertex.normal);
            vertex.uv[0] = uvs[i].x;
            vertex.uv[1] = uvs[i].y;
            triangle.vertex[i] = static_cast<uint>(scene.vertices.size());
            scene.vertices.push_back(vertex);
        }
        scene.triangles.push_back(triangle);
        return static_cast<std::uint32_t>(scene.triangles.size() - 1);
    }

    /// Two triangles a, b, c and a, c, d; uv runs from (0, 0) at a to (1, 1) at c.
    void add_quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
                  std::uint32_t material = 0) {
        add_triangle({a, b, c}, material, {}, {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1)});
        add_triangle({a, c, d}, material, {}, {glm::vec2(0, 0), glm::vec2(1, 1), glm::vec2(0, 1)});
    }

    void add_sphere(const glm::vec3& center, float radius, std::uint32_t material = 0) {
        Sphere sphere{};
        copy(center, sphere.center);
        sphere.radius = radius;
        sphere.material = material;
        scene.spheres.push_back(sphere);
    }

    void add_plane(const glm::vec3& point, const glm::vec3& normal, std::uint32_t material = 0) {
        Plane plane{};
        copy(point, plane.point);
        copy(normal, plane.normal);
        plane.material = material;
        scene.planes.push_back(plane);
    }
};

/// A material that does nothing at all: black, to be changed.
inline SceneMaterial black() {
    SceneMaterial material;
    material.diffuse = glm::vec3(0);
    return material;
}

inline SceneMaterial emitter(const glm::vec3& radiance) {
    SceneMaterial material = black();
    material.emission = radiance;
    return material;
}

inline void expect_near(const dvec3& actual, const dvec3& expected, double tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << "component " << i;
}

/// The terms of sample 0 of light 0 where `ray` first hits.
inline LocalTerms first_terms(const Scene& scene, const Ray& ray) {
    const Tracer tracer(scene);
    const Hit hit = tracer.intersect(ray);
    return tracer.local_terms(ray, hit, tracer.surface(ray, hit), 0, 0, 0, 0);
}

/// Radiance along a camera ray.
inline dvec3 radiance(const Scene& scene, const Ray& ray) {
    return Tracer(scene).radiance(ray, 0, 0, 0);
}

/// Rounding of a handful of operations on numbers near one.
constexpr double rounding = 1e-14;

}  // namespace raymill::reference
