// raymill compile: the kernels go into the OpenCL runtime's cache before the first render needs them.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "device/kernel_cache.hpp"

namespace raymill {

namespace {

struct CompileArguments {
    DeviceArguments device;
    std::vector<profile::Stage> stages;
};

/// One pixel of a mirror: kernels do not depend on the scene, but this one needs them all.
Scene smallest_scene() {
    Scene scene;
    scene.settings.width = scene.settings.height = 1;
    scene.settings.depth = 1;
    scene.materials.emplace_back().reflection = 1;
    scene.planes.push_back({{0, 0, 0}, {0, 1, 0}, 0, 0});
    scene.lights.emplace_back(PointLight{});
    return scene;
}

int compile(const CompileArguments& arguments) {
    const auto began = std::filesystem::file_time_type::clock::now();
    const Scene scene = smallest_scene();
    const Device device = arguments.device.open();
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    RenderOptions options = arguments.device.options();
    options.memory.queue_capacity = CHUNK;
    if (!arguments.stages.empty()) {
        options.compile = arguments.stages;
        options.compile_helper.clear();
    }
    const Renderer renderer(device, scene, bvh, options);
    const std::vector<LoadedKernel> kernels = loaded_kernels(began);
    if (kernels.empty())
        fmt::print("this OpenCL runtime does not tell what it compiled\n");
    else
        fmt::print("{} kernels compiled, {} found in the cache\n", std::ranges::count_if(kernels, &LoadedKernel::built),
                   std::ranges::count(kernels, false, &LoadedKernel::built));
    return 0;
}

}  // namespace

Command add_compile_command(CLI::App& app) {
    auto arguments = std::make_shared<CompileArguments>();
    CLI::App& command =
        *app.add_subcommand("compile", "Compile the kernels for a device ahead of the first render, into its cache");
    std::map<std::string, profile::Stage> names;
    for (const profile::Stage stage : RenderOptions().compile) names[std::string(profile::stage_name(stage))] = stage;
    command.add_option("--stages", arguments->stages, "Only these, as in shade,shadow")
        ->type_name("LIST")
        ->delimiter(',')
        ->transform(CLI::CheckedTransformer(names).description(""));
    arguments->device.add_without_memory_to(command);
    command.footer(
        "What a render would compile when it first runs with these flags; every other one then starts at once. Exit\n"
        "status: 0 done; 1 the kernels do not build; 2 bad arguments.\n\n"
        "Example: raymill compile");
    return [arguments] { return compile(*arguments); };
}

}  // namespace raymill
