// What a hit is - albedo, normal, position, ids, depth, samples - against the reference, hit by hit and field by field.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "kernel_rig.hpp"
#include "surface_cases.hpp"

namespace raymill::test {
namespace {

using glm::dvec3;

constexpr int WIDTH = 64, HEIGHT = 64;
constexpr double UNIT = 0x1p-32;  // of the film

SceneMaterial material_of(const glm::vec3& diffuse, float reflection, float transmission, const glm::vec3& base_color) {
    SceneMaterial m;
    m.diffuse = diffuse;
    m.reflection = reflection;
    m.transmission = transmission;
    m.base_color = base_color;
    return m;
}

Scene features_scene() {
    Scene scene;
    scene.settings.width = WIDTH;
    scene.settings.height = HEIGHT;
    scene.settings.spp = 4;
    scene.camera.eye = {1, 2, 5};
    scene.camera.look_at = {0.5, 0, -1};
    scene.materials = {material_of({0.75f, 0.5f, 0.25f}, 0, 0, {1, 1, 1}),
                       material_of({0.5f, 0.5f, 1}, 0.25f, 0.5f, {1, 0.5f, 0.25f}),
                       material_of({1, 1, 1}, 0.4f, 0.6f, {0.3f, 0.6f, 0.9f})};
    SceneMaterial textured = material_of({1, 0.5f, 0.75f}, 0.125f, 0, {0.5f, 1, 1});
    textured.diffuse_map = 0;
    scene.materials.push_back(textured);
    Random random(1);
    TextureImage image{"", 8, 4, {}};
    for (int i = 0; i < 32; ++i) image.texels.push_back(random.in_cube(0, 1));
    scene.images.push_back(image);
    add_surfaces(scene, 2);
    uint object = 0;  // each primitive is one of its own
    for (Triangle& triangle : scene.triangles) triangle.object = object++;
    for (Sphere& sphere : scene.spheres) sphere.object = object++;
    for (Plane& plane : scene.planes) plane.object = object++;
    return scene;
}

FilmPlanes all_features() {
    FilmPlanes planes;
    for (const int plane : {FILM_ALBEDO, FILM_NORMAL, FILM_POSITION, FILM_IDS}) planes.keep(plane);
    return planes;
}

class Features : public testing::Test {
  protected:
    /// The channel of a kept plane.
    std::int64_t at(const FilmState& film, int plane, uint pixel, int channel) const {
        return film.sums[(std::size_t{planes_.index(plane)} * WIDTH * HEIGHT + pixel) * FILM_CHANNELS +
                         static_cast<std::size_t>(channel)];
    }

    void expect_near(const FilmState& film, int plane, uint pixel, const dvec3& expected, const dvec3& error) const {
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(static_cast<double>(at(film, plane, pixel, k)) * UNIT, expected[k], error[k] + UNIT)
                << "plane " << plane << ", channel " << k;
    }

    void expect_nothing(const FilmState& film, int plane, uint pixel) const {
        for (int k = 0; k < FILM_CHANNELS; ++k) EXPECT_EQ(at(film, plane, pixel, k), 0) << "plane " << plane;
    }

    void expect_camera_hit(const FilmState& film, const Ray& ray, const Hit& hit) const {
        const reference::Surface s = tracer_.surface(exact(ray), exact(hit));
        const SceneMaterial& m = scene_.materials[s.material];
        const double passed_on = double{m.reflection} + m.transmission;
        const dvec3 albedo = (1 - passed_on) * tracer_.diffuse_color(s) + passed_on * dvec3(m.base_color);
        // Texels of at most 1: 8 a unit of uv (below 2, 8 roundings), twice; the blend has 6 roundings of at most 1.
        expect_near(film, FILM_ALBEDO, ray.pixel, albedo, dvec3((m.diffuse_map ? 2 * 8 * 18 + 6 : 6) * ROUNDING));
        // Seen edge on, within the error of its cosine, a surface may show either side.
        if (std::abs(glm::dot(exact(ray).direction, s.geometric_normal)) > 2 * NORMAL_ERROR)
            expect_near(film, FILM_NORMAL, ray.pixel, (s.inside ? -1.0 : 1.0) * s.shading_normal, dvec3(NORMAL_ERROR));
        expect_near(film, FILM_POSITION, ray.pixel, s.position, dvec3(POSITION_ERROR));
        // The eye is 12 from a hit at most: 3 roundings of a difference of coordinates below 8, 2 of the axis and 3 of
        // the product a term.
        const double z =
            glm::dot(s.position - scene_.camera.eye, glm::normalize(scene_.camera.look_at - scene_.camera.eye));
        EXPECT_NEAR(static_cast<double>(at(film, FILM_POSITION, ray.pixel, 3)) * UNIT, z,
                    POSITION_ERROR + (3 * 8 + 5 * 12) * ROUNDING + UNIT);
        const bool first = ray.sample == 0;
        EXPECT_EQ(at(film, FILM_IDS, ray.pixel, 0), first ? s.object + 1 : 0);
        EXPECT_EQ(at(film, FILM_IDS, ray.pixel, 1), first ? s.material + 1 : 0);
    }

    const Scene scene_ = features_scene();
    const FilmPlanes planes_ = all_features();
    const reference::Tracer tracer_{scene_};
    const KernelRig rig_{scene_, planes_};
};

TEST_F(Features, of_every_camera_hit_are_the_reference_s_and_other_rays_have_none) {
    const HitQueue queue = random_hits(scene_, 4000, 3, 17);
    const FilmState film = rig_.features(queue.rays, queue.hits, 3);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < queue.rays.size(); ++i) {
        const Ray& ray = queue.rays[i];
        SCOPED_TRACE(testing::Message() << "ray " << i << " on primitive " << queue.hits[i].primitive);
        const bool camera = ray.route == ROUTE_CAMERA;
        if (camera && queue.hits[i].primitive != NO_INDEX) {
            expect_camera_hit(film, ray, queue.hits[i]);
            ++compared;
        } else {
            for (const int plane : {FILM_ALBEDO, FILM_NORMAL, FILM_POSITION}) expect_nothing(film, plane, ray.pixel);
            EXPECT_EQ(at(film, FILM_IDS, ray.pixel, 0), 0);
            EXPECT_EQ(at(film, FILM_IDS, ray.pixel, 1), 0);
        }
        EXPECT_EQ(at(film, FILM_IDS, ray.pixel, 2), 3) << "a ray that misses was traced, too";
        EXPECT_EQ(at(film, FILM_IDS, ray.pixel, 3), camera ? 1 : 0);
        if (HasFailure()) return;
    }
    EXPECT_GT(compared, 1000u);
    EXPECT_EQ(film.counters.not_a_number + film.counters.saturated, 0u);
}

TEST_F(Features, of_rays_of_one_pixel_add_up_to_the_last_integer) {
    HitQueue queue = random_hits(scene_, 100, 4);
    const FilmState apart = rig_.features(queue.rays, queue.hits, 0);
    for (Ray& ray : queue.rays) ray.pixel = 7;
    const FilmState together = rig_.features(queue.rays, queue.hits, 0);
    for (const int plane : {FILM_ALBEDO, FILM_NORMAL, FILM_POSITION})
        for (int k = 0; k < FILM_CHANNELS; ++k) {
            std::int64_t sum = 0;
            for (uint pixel = 0; pixel < 100; ++pixel) sum += at(apart, plane, pixel, k);
            EXPECT_EQ(at(together, plane, 7, k), sum) << "plane " << plane << ", channel " << k;
        }
    const auto camera_rays = std::ranges::count(queue.rays, ROUTE_CAMERA, &Ray::route);
    EXPECT_EQ(at(together, FILM_IDS, 7, 3), camera_rays);
}

TEST_F(Features, of_planes_that_are_not_kept_are_not_written) {
    const HitQueue queue = random_hits(scene_, 300, 5);
    const FilmState whole = rig_.features(queue.rays, queue.hits, 2);
    for (const int kept : {FILM_ALBEDO, FILM_NORMAL, FILM_POSITION, FILM_IDS}) {
        FilmPlanes planes;
        planes.keep(kept);
        const FilmState film = KernelRig(scene_, planes).features(queue.rays, queue.hits, 2);
        constexpr std::size_t size = std::size_t{WIDTH} * HEIGHT * FILM_CHANNELS;
        ASSERT_EQ(film.sums.size(), 2 * size + FILM_CHANNELS);  // beauty, the plane, the guard
        const auto plane = whole.sums.begin() + static_cast<std::ptrdiff_t>(planes_.index(kept) * size);
        EXPECT_TRUE(std::equal(plane, plane + size, film.sums.begin() + size)) << "plane " << kept;
        EXPECT_TRUE(std::all_of(film.sums.begin(), film.sums.begin() + size, [](auto sum) { return sum == 0; }));
        EXPECT_TRUE(std::all_of(film.sums.begin() + 2 * size, film.sums.end(), [](auto sum) { return sum == 0; }));
    }
}

TEST_F(Features, of_a_part_of_a_queue_are_those_of_its_rays_alone) {
    const HitQueue queue = random_hits(scene_, 200, 6);
    const FilmState whole = rig_.features(queue.rays, queue.hits, 1);
    for (const uint first : {0u, 70u})
        for (const uint size : {0u, 1u, 63u, 64u, 65u, 130u}) {
            const FilmState part = rig_.features(queue.rays, std::span(queue.hits).subspan(first, size), 1, first);
            for (const int plane : {FILM_ALBEDO, FILM_NORMAL, FILM_POSITION, FILM_IDS})
                for (uint pixel = 0; pixel < 200; ++pixel)
                    for (int k = 0; k < FILM_CHANNELS; ++k) {
                        const bool in = pixel >= first && pixel < first + size;
                        ASSERT_EQ(at(part, plane, pixel, k), in ? at(whole, plane, pixel, k) : 0) << size;
                    }
        }
}

}  // namespace
}  // namespace raymill::test
