#include "wavefront/memory_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>

#include "wavefront/records.hpp"

namespace raymill {

namespace {

// Of a wave by default. Larger ones than 8k a compute unit gain little where two run at once (docs/queues.md), and deep
// recursion has many queues.
constexpr std::uint64_t rays_a_compute_unit = 1u << 13, largest_default = 1u << 16;
constexpr std::uint64_t smallest_default = CHUNK;

/// A power of two, so that halves of it are whole chunks.
std::uint64_t default_capacity(const DeviceInfo& device) {
    const std::uint64_t units = std::max(device.compute_units, 1u);
    return std::min(std::bit_floor(units * rays_a_compute_unit), largest_default);
}

MemoryPlan plan_with(const Scene& scene, const Bvh& bvh, const FilmPlanes& planes, std::uint64_t capacity,
                     int most_pipelines) {
    assert(most_pipelines >= 1);
    const std::uint64_t depth = spawns_secondary_rays(scene) ? static_cast<std::uint64_t>(scene.settings.depth) : 0;
    const std::uint64_t chunks = (capacity + CHUNK - 1) / CHUNK;
    const std::uint64_t slots = std::min<std::uint64_t>(light_slots(scene).size(), SHADOW_SAMPLES);
    const std::uint64_t camera_waves = std::max<std::uint64_t>((camera_samples(scene) + capacity - 1) / capacity, 1);
    const std::uint64_t pipelines = std::min(camera_waves, static_cast<std::uint64_t>(most_pipelines));

    MemoryPlan plan;
    plan.queue_capacity = static_cast<uint>(capacity);
    plan.queues = static_cast<int>(depth) + 1;
    plan.pipelines = static_cast<int>(pipelines);
    plan.geometry = bvh.nodes.size() * sizeof(BvhNode) + bvh.triangle_blocks.size() * sizeof(TriangleBlock) +
                    bvh.sphere_blocks.size() * sizeof(SphereBlock) + scene.vertices.size() * sizeof(Vertex) +
                    scene.triangles.size() * sizeof(Triangle) + scene.spheres.size() * sizeof(Sphere) +
                    scene.planes.size() * sizeof(Plane) + scene.materials.size() * sizeof(Material) +
                    scene.lights.size() * sizeof(LightRecord);
    for (const TextureImage& image : scene.images) plan.textures += image.texels.size() * 3 * sizeof(float);
    plan.ray_queues = pipelines * capacity * (1 + 2 * depth) * sizeof(Ray);
    plan.hits = pipelines * capacity * sizeof(Hit);
    plan.shadow_queue = pipelines * chunks * slots * (CHUNK * sizeof(ShadowRay) + sizeof(uint));
    plan.film = film_pixels(scene) * FILM_CHANNELS * (planes.count() * sizeof(cl_long) + sizeof(float));
    return plan;
}

/// The largest single buffer of the plan that grows with the capacity.
std::uint64_t largest_queue(const MemoryPlan& plan) {
    const std::uint64_t child_queue = 2 * std::uint64_t{plan.queue_capacity} * sizeof(Ray);
    return std::max(child_queue, plan.shadow_queue / static_cast<std::uint64_t>(plan.pipelines));
}

}  // namespace

MemoryPlan plan_memory(const Scene& scene, const Bvh& bvh, const FilmPlanes& planes, const MemoryRequest& request,
                       const DeviceInfo& device) {
    const std::uint64_t limit = request.limit > 0 ? request.limit : device.global_memory;
    const auto fits = [&](const MemoryPlan& plan) {
        return plan.total() <= limit && std::max(largest_queue(plan), plan.film) <= device.largest_buffer;
    };
    std::uint64_t capacity = request.queue_capacity > 0 ? request.queue_capacity : default_capacity(device);
    MemoryPlan plan = plan_with(scene, bvh, planes, capacity, request.pipelines);
    while (request.queue_capacity == 0 && !fits(plan) && capacity > smallest_default)
        plan = plan_with(scene, bvh, planes, capacity /= 2, request.pipelines);
    while (!fits(plan) && plan.pipelines > 1) plan = plan_with(scene, bvh, planes, capacity, plan.pipelines - 1);
    if (!fits(plan))
        throw DeviceError(fmt::format(
            "the frame needs {} (scene {}, film {}, queues of {} rays {}), more than the {} of {}: lower {}",
            human_bytes(plan.total()), human_bytes(plan.geometry + plan.textures), human_bytes(plan.film),
            plan.queue_capacity, human_bytes(plan.ray_queues + plan.hits + plan.shadow_queue), human_bytes(limit),
            request.limit > 0 ? "--mem-limit" : device.name,
            request.queue_capacity > 0 ? "--queue-capacity, --depth or --size" : "--depth or --size"));
    return plan;
}

std::uint64_t MemoryPlan::wave_bytes() const {
    const std::uint64_t rays_and_children = queues > 1 ? 3 : 1;  // a ray has two children at most
    return queue_capacity * rays_and_children * sizeof(Ray) +
           (hits + shadow_queue) / static_cast<std::uint64_t>(pipelines);
}

std::string human_bytes(std::uint64_t bytes) {
    constexpr const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double value = static_cast<double>(bytes);
    int unit = 0;
    for (; value >= 1024 && unit < 4; ++unit) value /= 1024;
    return fmt::format("{:.{}f} {}", value, unit == 0 ? 0 : 1, units[unit]);
}

}  // namespace raymill
