// Visibility against the reference's, ray by ray, and what the film makes of it, to the integer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "kernel_rig.hpp"
#include "queues.hpp"
#include "random.hpp"

namespace raymill::test {
namespace {

using glm::dvec3;

/// Filters are powers of two, so that their products are exact in either precision.
Scene obstacles(ShadowMode mode, bool any_opaque) {
    Mesh mesh = random_soup(120, 51, 0.25f);
    mesh.spheres = random_spheres(150, 52).spheres;
    Scene scene = scene_of(mesh);
    scene.settings.shadows = mode;
    const float transmissions[] = {0, 0.5f, 0.25f, 1};
    const glm::vec3 colors[] = {{1, 1, 1}, {1, 0.5f, 0.25f}, {0.5f, 0, 1}, {1, 1, 1}};
    for (int i = 0; i < 4; ++i) {
        if (i > 0) scene.materials.emplace_back();
        scene.materials.back().transmission = transmissions[i];
        scene.materials.back().base_color = colors[i];
    }
    Random random(53);
    const auto any = [&] { return any_opaque && random.below(6) == 0 ? 0 : 1 + random.below(3); };
    for (Triangle& triangle : scene.triangles) triangle.material = any();
    for (Sphere& sphere : scene.spheres) sphere.material = any();
    add_plane(scene, {0, 0.5f, 0}, {0, 1, 0}, 1);
    add_plane(scene, {0.5f, 0, 0}, glm::normalize(glm::vec3(3, 1, 2)), 2);
    return scene;
}

struct Segments {
    std::vector<ShadowRay> rays;  // CHUNK a segment; only the first `counts` of them are part of the queue
    std::vector<uint> counts;
};

/// A pixel each; segments are empty, full and in between. Terms are multiples of 1/64: sums and filtered products are
/// exact.
Segments random_segments(std::size_t segments, std::uint32_t seed) {
    Random random(seed);
    Segments queue;
    const uint sizes[] = {CHUNK, 0, 1, CHUNK - 1, 17};
    for (uint segment = 0; segment < segments; ++segment) {
        queue.counts.push_back(sizes[segment % 5]);
        for (uint i = 0; i < CHUNK; ++i) {
            const glm::vec3 origin = random.in_cube(-0.2f, 1.2f), target = random.in_cube(-0.2f, 1.2f);
            ShadowRay ray{};
            store(ray.origin, origin);
            store(ray.direction, towards(origin, target));
            ray.t_max = random.below(4) == 0 ? INFINITY : glm::length(target - origin);
            ray.pixel = segment * CHUNK + i;
            ray.route = random.below(3);
            for (int k = 0; k < 3; ++k) {
                ray.diffuse[k] = static_cast<float>(random.below(256)) / 64;
                ray.specular[k] = static_cast<float>(random.below(256)) / 64;
            }
            queue.rays.push_back(ray);
        }
    }
    return queue;
}

reference::Ray exact(const ShadowRay& ray) {
    return {reference::to_dvec3(ray.origin), reference::to_dvec3(ray.direction)};
}

/// Whether a segment within rounding of this one sees that colour: its origin moved by 16 roundings of coordinates and
/// length (below 4) across it and along it, its end as far.
bool may_be_seen(const reference::Tracer& tracer, const ShadowRay& shadow_ray, const auto& agrees) {
    const reference::Ray ray = exact(shadow_ray);
    const dvec3 across =
        glm::normalize(glm::cross(ray.direction, std::abs(ray.direction.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
    const dvec3 other = glm::cross(ray.direction, across);
    const double step = 16 * ROUNDING * 4;
    for (int i = 0; i < 16; ++i)
        for (const double end : {-step, 0.0, step})
            for (const double along : {-step, 0.0, step}) {
                reference::Ray moved = ray;
                const double angle = i * 0.3926990816987;
                moved.origin += step * (std::cos(angle) * across + std::sin(angle) * other) + along * ray.direction;
                if (agrees(tracer.visibility(moved, shadow_ray.t_max + end - along))) return true;
            }
    return false;
}

void expect_reference_visibility(const Scene& scene, std::uint32_t seed) {
    const Segments queue = random_segments(75, seed);
    const FilmState film = KernelRig(scene).shadow(queue.rays, queue.counts);
    const reference::Tracer tracer(scene);
    std::size_t decided_by_rounding = 0, rays = 0, dark = 0;
    for (std::size_t i = 0; i < queue.rays.size(); ++i) {
        const ShadowRay& ray = queue.rays[i];
        const std::int64_t* sums = &film.sums[i * FILM_CHANNELS];
        if (i % CHUNK >= queue.counts[i / CHUNK]) {
            for (int k = 0; k < 3; ++k) ASSERT_EQ(sums[k], 0) << "beyond the end of segment " << i / CHUNK;
            continue;
        }
        ++rays;
        const auto agrees = [&](const dvec3& visible) {
            bool all = true;
            for (int k = 0; k < 3; ++k) {
                const double light = visible[k] * (double{ray.diffuse[k]} + double{ray.specular[k]});
                all &= sums[k] == film_units(static_cast<float>(visible[k] * ray.diffuse[k])) +
                                      film_units(static_cast<float>(visible[k] * ray.specular[k])) &&
                       std::abs(static_cast<double>(sums[k]) * 0x1p-32 - light) <= 0x1p-32;
            }
            return all;
        };
        const dvec3 visible = tracer.visibility(exact(ray), ray.t_max);
        dark += visible == dvec3(0);
        if (agrees(visible)) continue;
        ++decided_by_rounding;
        ASSERT_TRUE(may_be_seen(tracer, ray, agrees))
            << "ray " << i << " sees " << visible.x << " " << visible.y << " " << visible.z << ", adds "
            << static_cast<double>(sums[0]) * 0x1p-32;
    }
    // Within 1e-5 of one of some 30 edges and limbs of size 0.2: one in 700.
    EXPECT_LE(decided_by_rounding, rays / 200);
    EXPECT_NEAR(static_cast<double>(film.counters.shadow_blocked), static_cast<double>(dark),
                static_cast<double>(decided_by_rounding));
    if (scene.settings.shadows != ShadowMode::none) {
        EXPECT_GT(dark, rays / 20);
    }
    EXPECT_LT(dark, rays);
}

TEST(Shadow, filtered_rays_see_what_the_reference_sees) {
    expect_reference_visibility(obstacles(ShadowMode::filtered, true), 61);
}
TEST(Shadow, opaque_rays_see_what_the_reference_sees) {
    expect_reference_visibility(obstacles(ShadowMode::opaque, true), 62);
}
TEST(Shadow, filtered_rays_without_any_filter_are_blocked_by_everything) {
    Scene scene = obstacles(ShadowMode::filtered, true);
    for (SceneMaterial& material : scene.materials) material.transmission = 0;
    expect_reference_visibility(scene, 63);
}
TEST(Shadow, rays_without_shadows_see_everything) {
    const Scene scene = obstacles(ShadowMode::none, true);
    expect_reference_visibility(scene, 64);
}

TEST(Shadow, a_blocked_ray_adds_nothing_and_is_counted) {
    Scene scene;
    scene.materials.emplace_back();
    add_sphere(scene, {0, 0, 5}, 1);
    std::vector<ShadowRay> rays(CHUNK);
    for (uint i = 0; i < 3; ++i) {
        store(rays[i].direction, {0, 0, i == 2 ? -1 : 1});
        rays[i].t_max = i == 0 ? 10.0f : 3.5f;  // through, before, away from the sphere
        rays[i].pixel = i;
        store(rays[i].diffuse, {1, 2, 3});
    }
    const FilmState film = KernelRig(scene).shadow(rays, std::vector<uint>{3});
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(film.at(0, k), 0);
        EXPECT_EQ(film.at(1, k), film_units(static_cast<float>(k + 1)));
        EXPECT_EQ(film.at(2, k), film_units(static_cast<float>(k + 1)));
    }
    EXPECT_EQ(film.counters.shadow_blocked, 1u);
}

/// Surfaces across the z axis at 1, 2 ... 60, each with a colour of its own: triangles, planes, and spheres that are
/// met twice and lie in one another. Built from far to near, so that ids do not go with distance.
struct Filters {
    Scene scene;
    std::vector<glm::vec3> colors;  // by distance
};

Filters filters_across_the_axis() {
    constexpr int count = 60;
    Filters filters;
    Random random(71);
    filters.scene.materials.emplace_back();              // none of theirs
    std::vector<uint> material(std::size_t{count} + 1);  // by distance; 0: not yet built
    Mesh mesh;
    std::vector<uint> of_triangle;
    for (int z = count; z >= 1; --z) {
        if (material[z] != 0) continue;
        material[z] = static_cast<uint>(filters.scene.materials.size());
        SceneMaterial& filter = filters.scene.materials.emplace_back();
        filter.transmission = 0.9375f;
        filter.base_color = random.in_cube(0.9f, 1);
        const auto at = static_cast<float>(z);
        if (z % 5 == 0 && z > 13) {  // leaves at z, enters at z - 13
            material[z - 13] = material[z];
            add_sphere(filters.scene, {0, 0, at - 6.5f}, 6.5f, material[z]);
        } else if (z % 7 == 0) {
            add_plane(filters.scene, {0, 0, at}, {0, 0, 1}, material[z]);
        } else {
            mesh.add_triangle({-3, -2, at}, {3, -2, at}, {0, 4, at});
            of_triangle.push_back(material[z]);
        }
    }
    filters.scene.vertices = mesh.vertices;
    filters.scene.triangles = mesh.triangles;
    for (std::size_t i = 0; i < of_triangle.size(); ++i) filters.scene.triangles[i].material = of_triangle[i];
    for (int z = 1; z <= count; ++z) {
        const SceneMaterial& filter = filters.scene.materials[material[z]];
        filters.colors.push_back(filter.base_color * filter.transmission);
    }
    return filters;
}

/// An opaque triangle across the z axis.
void add_wall(Scene& scene, float z) {
    const auto first = static_cast<uint>(scene.vertices.size());
    for (const glm::vec3& corner : {glm::vec3(-3, -2, z), glm::vec3(3, -2, z), glm::vec3(0, 4, z)}) {
        Vertex vertex{};
        store(vertex.position, corner);
        scene.vertices.push_back(vertex);
    }
    scene.triangles.push_back({{first, first + 1, first + 2}, static_cast<uint>(scene.materials.size()), 0});
    scene.materials.emplace_back();
}

/// A ray along the z axis for each number of surfaces from none to all: it ends behind that many.
std::vector<ShadowRay> rays_along_the_axis(std::size_t surfaces) {
    std::vector<ShadowRay> rays(CHUNK);
    for (uint i = 0; i <= surfaces; ++i) {
        store(rays[i].direction, {0, 0, 1});
        rays[i].t_max = static_cast<float>(i) + 0.5f;
        rays[i].pixel = i;
        store(rays[i].diffuse, glm::vec3(1));
    }
    return rays;
}

TEST(Shadow, every_filter_on_the_way_is_crossed_once_in_the_order_of_distance) {
    const Filters filters = filters_across_the_axis();
    const std::vector<ShadowRay> rays = rays_along_the_axis(filters.colors.size());
    const FilmState film =
        KernelRig(filters.scene).shadow(rays, std::vector<uint>{static_cast<uint>(filters.colors.size()) + 1});
    // The same single-precision products in the same order: equal to the last bit.
    glm::vec3 left(1);
    for (uint i = 0; i <= filters.colors.size(); ++i) {
        if (i > 0) left *= filters.colors[i - 1];
        for (int k = 0; k < 3; ++k) EXPECT_EQ(film.at(i, k), film_units(left[k])) << i << " surfaces, channel " << k;
    }
    EXPECT_EQ(film.counters.shadow_blocked, 0u);
}

TEST(Shadow, plain_adds_make_the_sums_and_counts_of_atomic_ones) {
    Filters filters = filters_across_the_axis();
    add_wall(filters.scene, 19.75f);
    std::vector<ShadowRay> rays = rays_along_the_axis(filters.colors.size());
    store(rays[5].specular, {0.25f, -0.5f, 1e30f});  // of which the film holds a part
    const std::vector<uint> counts = {static_cast<uint>(filters.colors.size()) + 1};
    const KernelRig rig(filters.scene);
    const FilmState atomic = rig.shadow(rays, counts), plain = rig.shadow(rays, counts, true);
    EXPECT_EQ(atomic.counters.saturated, 1u);
    EXPECT_EQ(plain.sums, atomic.sums);
    EXPECT_TRUE(same_bits(plain.counters, atomic.counters));
}

/// Shadow rays of a pixel each that keep all planes they add to.
class ShadowPlanes : public testing::Test {
  protected:
    ShadowPlanes() {
        scene_.settings.width = 80;
        scene_.settings.height = 60;  // as many pixels as places
        for (const int plane : kept_) planes_.keep(plane);
    }
    /// Where a pixel of a plane begins.
    std::size_t place(int plane, uint pixel) const {
        return (planes_.index(plane) * queue_.rays.size() + pixel) * FILM_CHANNELS;
    }

    const std::array<int, 6> kept_ = {FILM_BEAUTY,     FILM_DIFFUSE,    FILM_SPECULAR,
                                      FILM_REFLECTION, FILM_REFRACTION, FILM_SHADOW};
    Scene scene_ = obstacles(ShadowMode::filtered, true);
    FilmPlanes planes_;
    const Segments queue_ = random_segments(75, 71);
};

TEST_F(ShadowPlanes, hold_the_terms_of_camera_rays_what_branches_bring_and_the_light_that_is_left) {
    const FilmState film = KernelRig(scene_, planes_).shadow(queue_.rays, queue_.counts);
    std::array<std::size_t, 3> lit{};  // by route
    for (uint i = 0; i < queue_.rays.size(); ++i) {
        const ShadowRay& ray = queue_.rays[i];
        if (i % CHUNK >= queue_.counts[i / CHUNK]) {
            for (const int plane : kept_)
                for (int k = 0; k < FILM_CHANNELS; ++k) ASSERT_EQ(film.sums[place(plane, i) + k], 0) << i;
            continue;
        }
        const bool camera = ray.route == ROUTE_CAMERA;
        ASSERT_EQ(film.sums[place(FILM_SHADOW, i) + 3], camera ? FILM_ONE : 0) << i;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t beauty = film.sums[place(FILM_BEAUTY, i) + k];
            const std::int64_t left = film.sums[place(FILM_SHADOW, i) + k];
            const float share = static_cast<float>(static_cast<double>(left) * 0x1p-32);
            const std::int64_t diffuse = film_units(share * ray.diffuse[k]);
            const std::int64_t specular = film_units(share * ray.specular[k]);
            SCOPED_TRACE(testing::Message() << "ray " << i << ", channel " << k);
            ASSERT_EQ(film.sums[place(FILM_DIFFUSE, i) + k], diffuse);
            ASSERT_EQ(film.sums[place(FILM_SPECULAR, i) + k], specular);
            ASSERT_EQ(film.sums[place(FILM_REFLECTION, i) + k], ray.route == ROUTE_REFLECTED ? beauty : 0);
            ASSERT_EQ(film.sums[place(FILM_REFRACTION, i) + k], ray.route == ROUTE_REFRACTED ? beauty : 0);
            if (camera) {
                ASSERT_EQ(beauty, diffuse + specular);
            } else {
                ASSERT_EQ(left, 0);
            }
            lit[ray.route] += beauty != 0;
        }
    }
    for (const std::size_t channels : lit) EXPECT_GT(channels, 100u);
    EXPECT_EQ(film.counters.saturated + film.counters.not_a_number, 0u);
}

TEST_F(ShadowPlanes, of_neighbours_of_one_pixel_add_up_to_the_last_integer) {
    const KernelRig rig(scene_, planes_);
    const FilmState apart = rig.shadow(queue_.rays, queue_.counts);
    EXPECT_EQ(rig.shadow(queue_.rays, queue_.counts, true).sums, apart.sums);
    Random random(72);
    std::vector<ShadowRay> rays = queue_.rays;
    std::vector<std::int64_t> expected(apart.sums.size(), 0);
    for (uint i = 0, left = 0, pixel = 0; i < rays.size(); ++i) {
        if (left-- == 0) {
            left = random.below(40);  // of samples, more than go to the film at a time
            pixel = random.below(50);
        }
        rays[i].pixel = pixel;
        for (const int plane : kept_)
            for (int k = 0; k < FILM_CHANNELS; ++k)
                expected[place(plane, pixel) + k] += apart.sums[place(plane, i) + k];
    }
    EXPECT_EQ(rig.shadow(rays, queue_.counts).sums, expected);
}

TEST(Shadow, what_a_blocked_ray_would_bring_is_not_looked_at) {
    Filters filters = filters_across_the_axis();
    add_wall(filters.scene, 0.75f);  // behind the end of the first ray, before those of the others
    std::vector<ShadowRay> rays = rays_along_the_axis(filters.colors.size());
    const std::vector<uint> counts = {static_cast<uint>(filters.colors.size()) + 1};
    const KernelRig rig(filters.scene);
    rays[1].diffuse[0] = rays[20].specular[1] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(rig.shadow(rays, counts).counters.not_a_number, 0u);
    rays[0].diffuse[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(rig.shadow(rays, counts).counters.not_a_number, 1u);
}

TEST(Shadow, an_opaque_surface_among_many_filters_blocks) {
    for (const uint opaque : {3u, 17u, 40u, 60u}) {
        Filters filters = filters_across_the_axis();
        add_wall(filters.scene, static_cast<float>(opaque) - 0.25f);
        const std::vector<ShadowRay> rays = rays_along_the_axis(filters.colors.size());
        const FilmState film =
            KernelRig(filters.scene).shadow(rays, std::vector<uint>{static_cast<uint>(filters.colors.size()) + 1});
        for (uint i = 0; i <= filters.colors.size(); ++i)
            EXPECT_EQ(film.at(i, 0) == 0, i >= opaque) << i << " surfaces, wall before the one at " << opaque;
        EXPECT_EQ(film.counters.shadow_blocked, filters.colors.size() + 1 - opaque);
    }
}

TEST(Shadow, a_parallel_ray_to_a_directional_light_is_not_blocked_by_a_plane) {
    Scene scene;
    scene.materials.emplace_back();
    add_plane(scene, {0, 1, 0}, {0, 1, 0});
    std::vector<ShadowRay> rays(CHUNK);
    for (uint i = 0; i < 4; ++i) {
        store(rays[i].origin, {0, i < 2 ? 0 : 2, 0});
        store(rays[i].direction, {i % 2 ? 1 : -1, 0, 0});
        rays[i].t_max = INFINITY;
        rays[i].pixel = i;
        rays[i].diffuse[0] = 1;
    }
    for (const float transmission : {0.0f, 0.5f}) {
        scene.materials[0].transmission = transmission;
        const FilmState film = KernelRig(scene).shadow(rays, std::vector<uint>{4});
        for (uint i = 0; i < 4; ++i) EXPECT_EQ(film.at(i, 0), film_units(1)) << i;
    }
}

}  // namespace
}  // namespace raymill::test
