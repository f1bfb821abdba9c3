// Rays that are traced together, as packets, streams and flights, find what each finds alone: to the last bit.
#include <gtest/gtest.h>

#include <vector>

#include "kernel_rig.hpp"
#include "queues.hpp"
#include "random.hpp"
#include "support/changed_kernels.hpp"

namespace raymill::test {
namespace {

// Rays of a chunk that start at most so far apart and go to points at most this far apart; the others go anywhere.
struct Bundle {
    int close;
    float apart = 0;
    float spread = 0;
};

// One packet; one that comes apart; two octants or more; some strays beside a packet; strays alone; pinholes.
const Bundle BUNDLES[] = {{CHUNK, 0.01f, 0.02f}, {CHUNK, 0.01f, 0.3f}, {CHUNK, 0.01f, 1},
                          {40, 0.01f, 0.05f},    {24, 0.01f, 0.2f},    {0},
                          {CHUNK, 0, 0.3f},      {40, 0, 0.05f}};

/// Whole chunks of every bundle; the last one is not full.
template <class Item, class Make>
std::vector<Item> bundles(std::size_t rounds, std::uint32_t seed, const Make& make) {
    Random random(seed);
    std::vector<Item> items;
    for (std::size_t round = 0; round < rounds; ++round)
        for (const Bundle& bundle : BUNDLES) {
            const glm::vec3 eye = random.in_cube(-0.5f, 1.5f), target = random.in_cube(0, 1);
            for (int i = 0; i < CHUNK; ++i) {
                const bool is_close = i < bundle.close;
                const glm::vec3 from = is_close ? eye + random.in_cube(0, bundle.apart) : random.in_cube(-0.5f, 1.5f);
                const glm::vec3 to = is_close ? target + random.in_cube(0, bundle.spread) : random.in_cube(0, 1);
                items.push_back(make(from, to, static_cast<uint>(items.size())));
            }
        }
    items.resize(items.size() - 23);
    return items;
}

void add_triangles(Mesh& mesh, const Mesh& more) {
    const auto corner = [&](const Triangle& t, int i) { return vec3_of(more.vertices[t.vertex[i]].position); };
    for (const Triangle& t : more.triangles) mesh.add_triangle(corner(t, 0), corner(t, 1), corner(t, 2));
}

/// By packet kernels of the folder, if one is given.
void expect_the_same_together(Scene scene, std::uint32_t seed, const std::string& kernels = "") {
    scene.settings.background = {1, 0.5, 0.25};  // which tells the film whose rays miss
    KernelRig rig(scene);
    const auto rays = bundles<Ray>(12, seed, [](const glm::vec3& from, const glm::vec3& to, uint i) {
        return make_ray(from, towards(from, to), i);
    });
    rig.use(Traversal::packet, kernels);
    const auto together = rig.intersect(rays);
    rig.use(Traversal::single);
    const auto alone = rig.intersect(rays);
    std::size_t met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(same_bits(together.hits[i], alone.hits[i]))
            << "ray " << i << ": " << together.hits[i].primitive << " at " << together.hits[i].t << ", alone "
            << alone.hits[i].primitive << " at " << alone.hits[i].t;
        met += alone.hits[i].primitive != NO_INDEX;
    }
    EXPECT_GT(met, rays.size() / 20);
    EXPECT_EQ(together.film.sums, alone.film.sums);
    EXPECT_EQ(met < rays.size(), std::ranges::any_of(
                                     alone.film.sums, [](std::int64_t sum) { return sum != 0; }));

    auto shadow_rays = bundles<ShadowRay>(12, seed + 1, [](const glm::vec3& from, const glm::vec3& to, uint i) {
        ShadowRay ray{};
        store(ray.origin, from);
        store(ray.direction, towards(from, to));
        ray.t_max = i % 5 == 0 ? 0.2f : glm::length(to - from);  // every fifth ends soon
        ray.pixel = i;
        ray.diffuse[0] = 1;
        return ray;
    });
    std::vector<uint> counts(shadow_rays.size() / CHUNK, CHUNK);
    counts.push_back(static_cast<uint>(shadow_rays.size() % CHUNK));
    shadow_rays.resize(counts.size() * CHUNK);
    rig.use(Traversal::packet, kernels);
    const FilmState lit = rig.shadow(shadow_rays, counts);
    rig.use(Traversal::single);
    const FilmState lit_alone = rig.shadow(shadow_rays, counts);
    EXPECT_EQ(lit.sums, lit_alone.sums);
    EXPECT_EQ(lit.counters.shadow_blocked, lit_alone.counters.shadow_blocked);
    EXPECT_GT(lit_alone.counters.shadow_blocked, shadow_rays.size() / 40);
    EXPECT_LT(lit_alone.counters.shadow_blocked, shadow_rays.size());
}

TEST(Together, rays_meet_what_they_meet_alone) {
    expect_the_same_together(scene_of(random_soup(5000, 71, 0.05f)), 71);
}
TEST(Together, rays_that_share_little_meet_what_they_meet_alone) {
    // Boxes overlap everywhere, and what is in them is rarely hit: hundreds of visits a ray, each in an order of its
    // own.
    Mesh mesh = slivers(6000, 72);
    add_triangles(mesh, random_soup(200, 73, 0.2f));
    expect_the_same_together(scene_of(mesh), 72);
}
TEST(Together, rays_meet_the_first_of_many_that_are_the_same) {
    // Leaves of several blocks: nothing tells these triangles apart but their numbers.
    Mesh mesh = identical_triangles(60);
    add_triangles(mesh, random_soup(300, 74, 0.2f));
    expect_the_same_together(scene_of(mesh), 74);
}
TEST(Together, rays_meet_spheres_triangles_and_planes_alike) {
    Mesh mesh = random_soup(800, 75, 0.1f);
    mesh.spheres = random_spheres(1500, 76).spheres;
    Scene scene = scene_of(mesh);
    add_plane(scene, {0.5f, 0.1f, 0.5f}, {0, 1, 0});
    add_plane(scene, {0.5f, 0.5f, 0.9f}, glm::normalize(glm::vec3(-1, 2, -3)));
    expect_the_same_together(scene, 75);
}

TEST(Together, any_hits_of_streams_that_fill_their_stacks_are_those_of_rays_alone) {
    const TemporaryFolder folder;
    change_kernels(folder.path() / "kernels", "lib/stream.h", "#define STREAM_FULL 512", "#define STREAM_FULL 4");
    if (HasFatalFailure()) return;
    Mesh mesh = slivers(3000, 77);
    add_triangles(mesh, random_soup(200, 78, 0.2f));
    expect_the_same_together(scene_of(mesh), 77, folder.path() / "kernels");
}

}  // namespace
}  // namespace raymill::test
