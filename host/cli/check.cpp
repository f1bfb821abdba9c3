// raymill check: loads and validates a scene, and says what rendering it takes.
#include <fmt/format.h>

#include <limits>

#include "bvh/bvh.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "wavefront/memory_plan.hpp"
#include "wavefront/records.hpp"

namespace raymill {

namespace {

struct CheckArguments {
    SceneArguments scene;
    DeviceArguments device;
};

/// The device that would render; one without limits where there is none, since checking a scene needs no OpenCL.
DeviceInfo planned_device(const DeviceArguments& arguments) {
    if (!list_devices().empty()) return arguments.open().info;
    DeviceInfo none;
    none.name = "no OpenCL device";
    none.global_memory = none.largest_buffer = std::numeric_limits<std::uint64_t>::max();
    return none;
}

std::string point(glm::vec3 p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

void print_scene(const Scene& scene) {
    const RenderSettings& settings = scene.settings;
    fmt::print("scene       {}\n", scene.file);
    fmt::print("image       {} x {} pixels, {} spp, depth {}\n", settings.width, settings.height, settings.spp,
               settings.depth);
    fmt::print("geometry    {} triangles, {} spheres, {} planes, {} vertices\n", scene.triangles.size(),
               scene.spheres.size(), scene.planes.size(), scene.vertices.size());
    fmt::print("materials   {}\n", scene.materials.size());
    fmt::print("lights      {}, {} shadow rays a hit\n", scene.lights.size(), light_slots(scene).size());
    for (const TextureImage& image : scene.images)
        fmt::print("texture     {}, {} x {}\n", image.file, image.width, image.height);
    for (const SceneObject& object : scene.objects) {
        fmt::print("object      {}{}{}", object.shape, object.name.empty() ? "" : " ", object.name);
        if (object.chord_error > 0) fmt::print(", chord error {:.2g}", object.chord_error);
        fmt::print("\n");
    }
}

void print_hierarchy(const Scene& scene, const Bvh& bvh) {
    const BvhStatistics& s = bvh.statistics;
    if (bvh.nodes.empty()) {
        fmt::print("hierarchy   empty\n");
    } else {
        fmt::print("bounds      {} to {}\n", point(bvh.bounds.lower), point(bvh.bounds.upper));
        fmt::print("hierarchy   {} nodes, {} triangle blocks, {} sphere blocks, depth {}, SAH cost {:.2f}, {:.3f} s\n",
                   bvh.nodes.size(), bvh.triangle_blocks.size(), bvh.sphere_blocks.size(), s.depth,
                   s.surface_area_cost, s.seconds);
        const auto count = static_cast<double>(scene.primitive_count() - s.dropped_not_finite - s.dropped_zero_area);
        fmt::print("            {:.1f} bytes a primitive, {:.2f} million primitives a second\n",
                   static_cast<double>(bvh.bytes()) / count, 1e-6 * count / s.seconds);
    }
    if (s.dropped_not_finite > 0) fmt::print("left out    {} triangles with a vertex that is not finite\n", s.dropped_not_finite);
    if (s.dropped_zero_area > 0) fmt::print("left out    {} triangles without area\n", s.dropped_zero_area);
}

void print_memory(const MemoryPlan& plan, const DeviceInfo& device) {
    fmt::print("device      {}\n", device.name);
    fmt::print("memory      {} at most on the device: geometry {}, textures {}, film {},\n", human_bytes(plan.total()),
               human_bytes(plan.geometry), human_bytes(plan.textures), human_bytes(plan.film));
    fmt::print("            {}{} ray queues for batches of {} rays {}, hits {}, shadow rays {}\n",
               plan.pipelines > 1 ? fmt::format("{} times ", plan.pipelines) : "", plan.queues, plan.queue_capacity,
               human_bytes(plan.ray_queues), human_bytes(plan.hits), human_bytes(plan.shadow_queue));
    // The program keeps what it uploads, and reads the film back.
    fmt::print("            {} beside that in the program, for the scene, its hierarchy and the film\n",
               human_bytes(plan.geometry + plan.textures + plan.film));
}

int check(const CheckArguments& arguments) {
    const RenderOptions options = arguments.device.options();
    const Scene scene = arguments.scene.load();
    print_warnings(scene.warnings);
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    print_scene(scene);
    print_hierarchy(scene, bvh);
    const DeviceInfo device = planned_device(arguments.device);
    print_memory(plan_memory(scene, bvh, options.planes, options.memory, device), device);
    return 0;
}

}  // namespace

Command add_check_command(CLI::App& app) {
    auto arguments = std::make_shared<CheckArguments>();
    CLI::App& command =
        *app.add_subcommand("check", "Load and validate a scene; print counts, bounds, memory and the hierarchy");
    arguments->scene.add_to(command);
    arguments->device.add_to(command);
    arguments->device.add_pipelines_to(command);
    command.footer("Example:\n  raymill check scenes/first-light.toml\n\nAll faults of a scene are reported at once, with line and column; exit status 2.");
    return [arguments] { return check(*arguments); };
}

}  // namespace raymill
