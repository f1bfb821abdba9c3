// The memory plan: known before the first ray, kept to, and within the limit or refused with a sentence.
#include "wavefront/memory_plan.hpp"

#include <gtest/gtest.h>

#include "allocations.hpp"
#include "rendering.hpp"

namespace raymill {
namespace {

Scene glass_scene(int depth) {
    Scene scene = scene_of(R"(
[render]
size = [100, 80]
[[material]]
name = "glass"
diffuse_map = "checker.exr"
reflection = 0.3
transmission = 0.6
[[light]]
type = "directional"
direction = [0, -1, 0]
[[light]]
type = "point"
position = [3, 3, 3]
radius = 0.2
samples = 5
[[object]]
shape = "sphere"
material = "glass"
center = [0, 1, 0]
radius = 1
[[object]]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
[[object]]
)" + grid_mesh_keys(2, 20));
    scene.settings.depth = depth;
    return scene;
}

MemoryPlan plan_of(const Scene& scene, const MemoryRequest& request) {
    return plan_memory(scene, bvh_of(scene), {}, request, test_device().info);
}

std::string refusal(const Scene& scene, const MemoryRequest& request) {
    try {
        plan_of(scene, request);
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "no error";
}

/// Records of fixed size (camera, constants, counters, texture and light-sample lists, one element of each empty
/// array) are not worth a line of the plan: all together are below a page.
constexpr std::uint64_t small_records = 4096;

void expect_kept(const Scene& scene, const RenderOptions& options) {
    const Bvh bvh = bvh_of(scene);
    const std::uint64_t before = allocated_bytes();
    Renderer renderer(test_device(), scene, bvh, options);
    renderer.render();
    const std::uint64_t allocated = allocated_bytes() - before;
    const std::uint64_t planned = renderer.memory().total();
    EXPECT_GE(allocated, planned);
    EXPECT_LE(allocated, planned + small_records);
    EXPECT_GT(planned, 20 * small_records);  // so that a queue left out would show
}

TEST(the_memory_plan, is_what_a_frame_allocates) {
    expect_kept(glass_scene(6), options_with(5000));
    expect_kept(glass_scene(0), options_with(5000));
    expect_kept(glass_scene(6), options_with(1000));
}

TEST(the_memory_plan, is_what_a_frame_with_aovs_allocates) {
    RenderOptions options = options_with(1000);
    options.planes.keep_light();
    options.planes.keep(FILM_NORMAL);
    expect_kept(glass_scene(2), options);
}

TEST(the_memory_plan, has_two_queues_of_children_a_depth) {
    const MemoryPlan plan = plan_of(glass_scene(6), {8000, 0});
    EXPECT_EQ(plan.queue_capacity, 8000u);
    EXPECT_EQ(plan.queues, 7);
    EXPECT_EQ(plan.ray_queues, 8000u * (1 + 2 * 6) * sizeof(Ray));
    EXPECT_EQ(plan.film, 100u * 80u * 4u * (8u + 4u));
}

TEST(the_memory_plan, has_two_pipelines_where_one_wave_does_not_hold_all_camera_rays) {
    const MemoryPlan one = plan_of(glass_scene(6), {8000, 0}), two = plan_of(glass_scene(6), {7999, 0});
    EXPECT_EQ(one.pipelines, 1);
    EXPECT_EQ(two.pipelines, 2);
    EXPECT_EQ(two.ray_queues, 2u * 7999u * (1 + 2 * 6) * sizeof(Ray));
    EXPECT_EQ(two.hits, 2u * 7999u * sizeof(Hit));
    EXPECT_EQ(two.shadow_queue, 2 * one.shadow_queue);  // of as many chunks
    EXPECT_EQ(two.film, one.film);
    EXPECT_EQ(one.wave_bytes() - two.wave_bytes(), 3 * sizeof(Ray) + sizeof(Hit));
}

TEST(the_memory_plan, has_waves_that_grow_with_the_compute_units) {
    const Scene scene = glass_scene(0);
    const Bvh bvh = bvh_of(scene);
    const auto capacity = [&](unsigned compute_units) {
        DeviceInfo device = test_device().info;
        device.compute_units = compute_units;
        device.global_memory = device.largest_buffer = 1ull << 40;
        return plan_memory(scene, bvh, {}, {}, device).queue_capacity;
    };
    EXPECT_EQ(capacity(0), 8192u);
    EXPECT_EQ(capacity(1), 8192u);
    EXPECT_EQ(capacity(2), 16384u);
    EXPECT_EQ(capacity(3), 16384u);
    EXPECT_EQ(capacity(8), 65536u);
    EXPECT_EQ(capacity(100000), 65536u);
}

TEST(the_memory_plan, does_with_one_pipeline_where_two_do_not_fit) {
    const Scene scene = glass_scene(6);
    EXPECT_EQ(plan_of(scene, {4000, 0, 1}).pipelines, 1);
    EXPECT_EQ(plan_of(scene, {4000, 0, 16}).pipelines, 2);  // camera rays are two waves
    EXPECT_EQ(plan_of(scene, {1000, plan_of(scene, {1000, 0, 4}).total() - 1, 4}).pipelines, 3);
    const std::uint64_t two = plan_of(scene, {4000, 0}).total();
    EXPECT_EQ(plan_of(scene, {4000, two}).pipelines, 2);
    const MemoryPlan one = plan_of(scene, {4000, two - 1});
    EXPECT_EQ(one.pipelines, 1);
    EXPECT_EQ(one.queue_capacity, 4000u);
    // By itself it takes smaller waves first.
    const std::uint64_t smallest = plan_of(scene, {CHUNK, 0}).total();
    EXPECT_EQ(plan_of(scene, {0, smallest}).pipelines, 2);
    EXPECT_EQ(plan_of(scene, {0, smallest - 1}).pipelines, 1);
}

TEST(the_memory_plan, needs_no_queues_for_children_that_no_material_spawns) {
    Scene scene = glass_scene(6);
    for (SceneMaterial& material : scene.materials) material.reflection = material.transmission = 0;
    EXPECT_EQ(plan_of(scene, {5000, 0}).queues, 1);
}

TEST(a_memory_limit, shrinks_the_queues_by_itself) {
    const Scene scene = glass_scene(6);
    const MemoryPlan unlimited = plan_of(scene, {0, 0});
    const std::uint64_t limit = unlimited.total() / 5;
    const MemoryPlan plan = plan_of(scene, {0, limit});
    EXPECT_LE(plan.total(), limit);
    EXPECT_LT(plan.queue_capacity, unlimited.queue_capacity);
    EXPECT_GE(2 * plan.total() + small_records, limit);  // by halving, and not further than it must
}

TEST(a_memory_limit, does_not_change_the_picture) {
    Scene scene = glass_scene(3);
    scene.settings.width = scene.settings.height = 24;
    RenderOptions limited;
    limited.memory.limit = 200 << 10;
    const Bvh bvh = bvh_of(scene);
    Renderer renderer(test_device(), scene, bvh, limited);
    EXPECT_LE(renderer.memory().total(), limited.memory.limit);
    EXPECT_EQ(renderer.render().hash(), render(scene).hash());
}

TEST(a_memory_limit, that_is_too_small_is_refused_with_what_to_do) {
    const Scene scene = glass_scene(6);
    const std::string by_itself = refusal(scene, {0, 100000});
    EXPECT_NE(by_itself.find("the frame needs"), std::string::npos) << by_itself;
    EXPECT_NE(by_itself.find("97.7 KiB of --mem-limit"), std::string::npos) << by_itself;
    EXPECT_EQ(by_itself.find("--queue-capacity"), std::string::npos) << by_itself;
    const std::string asked_for = refusal(scene, {1 << 20, 1 << 20});
    EXPECT_NE(asked_for.find("--queue-capacity"), std::string::npos) << asked_for;
}

TEST(a_memory_limit, refuses_queues_beyond_the_largest_buffer) {
    const Scene scene = glass_scene(6);
    DeviceInfo small = test_device().info;
    small.largest_buffer = 1 << 20;
    EXPECT_THROW(plan_memory(scene, bvh_of(scene), {}, {1 << 16, 0}, small), DeviceError);
    EXPECT_LE(plan_memory(scene, bvh_of(scene), {}, {0, 0}, small).queue_capacity * 2 * sizeof(Ray), 1u << 20);
}

TEST(a_memory_limit, of_the_largest_buffer_is_that_of_one_pipeline) {
    const Scene scene = glass_scene(0);
    const Bvh bvh = bvh_of(scene);
    DeviceInfo device = test_device().info;
    const std::uint64_t queue = plan_memory(scene, bvh, {}, {4000, 0}, device).shadow_queue / 2;
    ASSERT_GT(queue, plan_memory(scene, bvh, {}, {4000, 0}, device).film);
    device.largest_buffer = queue;
    EXPECT_EQ(plan_memory(scene, bvh, {}, {4000, 0}, device).pipelines, 2);
    device.largest_buffer = queue - 1;
    EXPECT_THROW(plan_memory(scene, bvh, {}, {4000, 0}, device), DeviceError);
}

TEST(human_bytes, have_a_unit_that_keeps_the_number_short) {
    EXPECT_EQ(human_bytes(0), "0 B");
    EXPECT_EQ(human_bytes(1023), "1023 B");
    EXPECT_EQ(human_bytes(1536), "1.5 KiB");
    EXPECT_EQ(human_bytes(3ull << 40), "3.0 TiB");
}

}  // namespace
}  // namespace raymill
