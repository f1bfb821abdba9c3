// Closed meshes let no ray escape, and a segment through one crosses it exactly twice, also through edges and vertices.
#include <gtest/gtest.h>

#include <vector>

#include "kernel_rig.hpp"
#include "queues.hpp"
#include "random.hpp"

namespace raymill::test {
namespace {

struct Closed {
    const char* name;
    glm::vec3 center;
    float size;
    bool box;

    Mesh mesh() const {
        return box ? test::box(center - glm::vec3(size), center + glm::vec3(size, 0.75f * size, 1.5f * size))
                   : icosphere(4, size, center);
    }
};

std::ostream& operator<<(std::ostream& out, const Closed& closed) {
    return out << closed.name;
}

// Far from the origin the spheres are large enough for their triangles to keep their shape on the grid of floats.
const Closed shapes[] = {{"icosphere_at_the_origin", {0, 0, 0}, 1, false},
                         {"icosphere_far_away", {1e5f, -1e5f, 1e5f}, 500, false},
                         {"tiny_icosphere", {0, 0, 0}, 1e-4f, false},
                         {"box_at_the_origin", {0, 0, 0}, 1, true},
                         {"box_far_away", {1e5f, 1e5f, -1e5f}, 100, true}};

class Watertight : public testing::TestWithParam<Closed> {};

/// A vertex, or a point on an edge of a random triangle, as closely as floats allow.
glm::vec3 border_point(const Mesh& mesh, Random& random) {
    const Triangle& triangle = mesh.triangles[random.below(static_cast<uint>(mesh.triangles.size()))];
    const uint corner = random.below(3);
    const glm::vec3 a = vec3_of(mesh.vertices[triangle.vertex[corner]].position);
    const glm::vec3 b = vec3_of(mesh.vertices[triangle.vertex[(corner + 1) % 3]].position);
    const uint kind = random.below(3);
    if (kind == 0) return a;
    if (kind == 1) return 0.5f * (a + b);
    return a + random.in(0, 1) * (b - a);
}

TEST_P(Watertight, no_ray_from_inside_escapes) {
    const Closed shape = GetParam();
    const Mesh mesh = shape.mesh();
    Random random(1);
    std::vector<Ray> rays;
    for (int i = 0; i < 1000000; ++i) {
        const glm::vec3 origin = shape.center + 0.7f * shape.size * random.in_cube(-0.55f, 0.55f);
        rays.push_back(make_ray(origin, random.direction()));
    }
    const auto hits = KernelRig(scene_of(mesh)).intersect(rays).hits;
    std::size_t escaped = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) escaped += hits[i].primitive == NO_INDEX;
    EXPECT_EQ(escaped, 0u);
}

TEST_P(Watertight, no_ray_at_an_edge_or_a_vertex_escapes) {
    const Closed shape = GetParam();
    const Mesh mesh = shape.mesh();
    Random random(2);
    std::vector<Ray> rays;
    for (int i = 0; i < 100000; ++i) {
        // Every fourth from the centre itself: its differences to the vertices are exact more often.
        const glm::vec3 origin =
            i % 4 == 0 ? shape.center : shape.center + 0.7f * shape.size * random.in_cube(-0.5f, 0.5f);
        rays.push_back(make_ray(origin, towards(origin, border_point(mesh, random))));
    }
    const auto hits = KernelRig(scene_of(mesh)).intersect(rays).hits;
    std::size_t escaped = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) escaped += hits[i].primitive == NO_INDEX;
    EXPECT_EQ(escaped, 0u);
}

TEST_P(Watertight, a_segment_through_edges_and_vertices_crosses_exactly_twice) {
    const Closed shape = GetParam();
    const Mesh mesh = shape.mesh();
    Scene scene = scene_of(mesh);
    scene.materials[0].transmission = 0.5f;
    Random random(3);
    std::vector<ShadowRay> rays;
    while (rays.size() < 100032) {
        // From outside at a border point in front, and on through points well inside: never along a silhouette.
        const glm::vec3 target = border_point(mesh, random);
        const glm::vec3 inside = shape.center + 0.5f * shape.size * random.in_cube(-0.5f, 0.5f);
        const glm::vec3 origin = target + 2.0f * (target - inside);
        ShadowRay ray{};
        store(ray.origin, origin);
        store(ray.direction, towards(origin, target));
        ray.t_max = 20 * shape.size;
        ray.pixel = static_cast<uint>(rays.size());
        store(ray.diffuse, glm::vec3(1, 2, 0));
        rays.push_back(ray);
    }
    const std::vector<uint> counts(rays.size() / CHUNK, CHUNK);
    const FilmState film = KernelRig(scene).shadow(rays, counts);
    std::size_t wrong = 0;
    for (uint i = 0; i < rays.size(); ++i)
        wrong += film.at(i, 0) != film_units(0.25f) || film.at(i, 1) != film_units(0.5f);
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(film.counters.shadow_blocked, 0u);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Watertight, testing::ValuesIn(shapes), testing::PrintToStringParamName());

TEST(Crossings, coincident_surfaces_filter_once_each) {
    Scene scene;
    scene.materials.emplace_back();
    scene.materials[0].transmission = 0.5f;
    for (int copy = 0; copy < 3; ++copy) add_sphere(scene, {0, 0, 0}, 1);
    for (int copy = 0; copy < 2; ++copy) add_plane(scene, {0, 0, 0}, {0, 0, 1});
    const Mesh sheet = uneven_sheet(1);
    scene.vertices = sheet.vertices;
    for (int copy = 0; copy < 2; ++copy)
        scene.triangles.insert(scene.triangles.end(), sheet.triangles.begin(), sheet.triangles.end());
    std::vector<ShadowRay> rays(CHUNK);
    Random random(4);
    for (uint i = 0; i < CHUNK; ++i) {
        const glm::vec3 origin(0.3f, 0.4f, 5), target(random.in(0.2f, 0.6f), random.in(0.2f, 0.6f), 0);
        store(rays[i].origin, origin);
        store(rays[i].direction, towards(origin, target));
        rays[i].t_max = 20;
        rays[i].pixel = i;
        store(rays[i].diffuse, glm::vec3(1024, 0, 0));
    }
    const FilmState film = KernelRig(scene).shadow(rays, std::vector<uint>{CHUNK});
    // Three spheres twice, two planes, two sheets: ten crossings.
    for (uint i = 0; i < CHUNK; ++i) EXPECT_EQ(film.at(i, 0), film_units(1.0f)) << i;
}

}  // namespace
}  // namespace raymill::test
