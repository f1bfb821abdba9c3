#include "surface_cases.hpp"

#include <algorithm>

namespace raymill::test {

namespace {

/// A triangle of edges around one whose edges' product is at most 4 times twice its area.
void add_fat_triangle(Scene& scene, uint material, bool smooth, Random& random) {
    glm::vec3 p[3];
    double shape = 0;
    do {
        const glm::vec3 center = random.in_cube(-2, 2);
        for (glm::vec3& corner : p) corner = center + random.in_cube(-1, 1);
        const glm::dvec3 e = p[1] - p[0], f = p[2] - p[0];
        shape = glm::length(glm::cross(e, f)) / (glm::length(e) * glm::length(f));
    } while (!(shape > 0.25));
    const glm::vec3 face = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    Triangle triangle{};
    triangle.material = material;
    for (uint corner = 0; corner < 3; ++corner) {
        Vertex vertex{};
        store(vertex.position, p[corner]);
        if (smooth) store(vertex.normal, glm::normalize(face + random.in_cube(-0.4f, 0.4f)));
        vertex.uv[0] = random.in(-1.5f, 1.5f);
        vertex.uv[1] = random.in(-1.5f, 1.5f);
        triangle.vertex[corner] = static_cast<uint>(scene.vertices.size());
        scene.vertices.push_back(vertex);
    }
    scene.triangles.push_back(triangle);
}

/// A point of the primitive, and the weights of a triangle's vertices 1 and 2 there.
glm::vec3 point_on(const Scene& scene, uint primitive, Random& random, Hit& hit) {
    if (primitive < scene.triangles.size()) {
        glm::vec3 corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = vec3_of(scene.vertices[scene.triangles[primitive].vertex[k]].position);
        hit.u = random.in(0, 1);
        hit.v = random.in(0, 1 - hit.u);
        return corner[0] + hit.u * (corner[1] - corner[0]) + hit.v * (corner[2] - corner[0]);
    }
    primitive -= static_cast<uint>(scene.triangles.size());
    if (primitive < scene.spheres.size()) {
        const Sphere& sphere = scene.spheres[primitive];
        return vec3_of(sphere.center) + sphere.radius * random.direction();
    }
    const Plane& plane = scene.planes[primitive - scene.spheres.size()];
    const glm::vec3 normal = vec3_of(plane.normal), p = random.in_cube(-2, 2);
    return p - glm::dot(p - vec3_of(plane.point), normal) * normal;
}

}  // namespace

void add_surfaces(Scene& scene, std::uint32_t seed) {
    Random random(seed);
    for (uint material = 0; material < scene.materials.size(); ++material) {
        for (int i = 0; i < 4; ++i) add_fat_triangle(scene, material, i > 0, random);
        add_sphere(scene, random.in_cube(-2, 2), random.in(0.5f, 1.5f), material);
        add_plane(scene, random.in_cube(-1, 1), random.direction(), material);
    }
}

HitQueue random_hits(const Scene& scene, std::size_t count, std::uint32_t seed, uint miss_every) {
    Random random(seed);
    HitQueue queue;
    for (uint i = 0; i < count; ++i) {
        Hit hit{};
        hit.primitive = random.below(scene.primitive_count());
        const glm::vec3 target = point_on(scene, hit.primitive, random, hit);
        const glm::vec3 origin = target + random.in(0.5f, 4) * random.direction();
        Ray ray = make_ray(origin, towards(origin, target), i);
        hit.t = static_cast<float>(glm::length(glm::dvec3(target) - glm::dvec3(origin)));
        if (miss_every > 0 && i % miss_every == 0) hit = {INFINITY, 0, 0, NO_INDEX};
        store(ray.throughput, random.in_cube(0, 1));
        ray.route = random.below(3);
        ray.sample = random.below(static_cast<uint>(scene.settings.spp));
        ray.path = random.bits();
        queue.rays.push_back(ray);
        queue.hits.push_back(hit);
    }
    return queue;
}

double height_over(const Scene& scene, uint primitive, const glm::dvec3& point) {
    using reference::to_dvec3;
    if (primitive < scene.triangles.size()) {
        const Triangle& triangle = scene.triangles[primitive];
        const glm::dvec3 a = to_dvec3(scene.vertices[triangle.vertex[0]].position);
        const glm::dvec3 b = to_dvec3(scene.vertices[triangle.vertex[1]].position);
        const glm::dvec3 c = to_dvec3(scene.vertices[triangle.vertex[2]].position);
        return glm::dot(point - a, glm::normalize(glm::cross(b - a, c - a)));
    }
    primitive -= static_cast<uint>(scene.triangles.size());
    if (primitive < scene.spheres.size()) {
        const Sphere& sphere = scene.spheres[primitive];
        return glm::length(point - to_dvec3(sphere.center)) - sphere.radius;
    }
    const Plane& plane = scene.planes[primitive - scene.spheres.size()];
    return glm::dot(point - to_dvec3(plane.point), glm::normalize(to_dvec3(plane.normal)));
}

}  // namespace raymill::test
