// raymill verify: every kernel's every item beside the scalar reference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bvh/bvh.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "verify/capture_check.hpp"

namespace raymill {

namespace {

constexpr int out_of_bounds = 1;
constexpr int default_side = 64;

struct VerifyArguments {
    SceneArguments scene;
    std::string capture;
    DeviceArguments device;
    verify::VerifyOptions options;
};

/// The scene's aspect ratio in about default_side x default_side pixels.
void shrink(RenderSettings& settings) {
    const double aspect = static_cast<double>(settings.width) / settings.height;
    settings.width = std::max(1, static_cast<int>(std::lround(default_side * std::sqrt(aspect))));
    settings.height = std::max(1, static_cast<int>(std::lround(default_side / std::sqrt(aspect))));
}

/// Prints the reports; the exit status.
int conclude(const std::vector<verify::StageReport>& reports) {
    fmt::print("Errors are shares of the bound that single precision allows them; so are the margins of branches.\n");
    fmt::print("{}", verify::report_text(reports));
    const bool failed = std::ranges::any_of(reports, [](const verify::StageReport& r) { return r.failures() > 0; });
    fmt::print("{}\n", failed ? "out of bounds" : "all within bounds");
    return failed ? out_of_bounds : 0;
}

int verify_captured(const VerifyArguments& arguments) try {
    if (arguments.scene.has_overrides())
        throw UsageError(
            fmt::format("--capture {}: size, samples, depth, crop and seed are those of the captured "
                        "frame; leave out the flags that say others",
                        arguments.capture));
    const RenderOptions options = arguments.device.options();
    const auto [capture, scene] = capture::load_capture(arguments.capture, arguments.scene.file, "SCENE");
    print_warnings(scene.warnings);
    const Device device = arguments.device.open();
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    Stages stages(device, options.work_group, options.kernel_dir, options.traversal);
    const DeviceScene on_device(device, scene, bvh, capture.frame.planes);
    const auto report = verify::verify_capture(device, scene, stages, on_device, capture, arguments.options);
    fmt::print("{}: {} at depth {}, launch {}, of {}, {} primitives, on {}\n", arguments.capture,
               profile::stage_name(capture.stage), capture.depth, capture.launch, scene.file, scene.primitive_count(),
               device.info.name);
    return conclude({report});
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

int verify_scene(const VerifyArguments& arguments) {
    if (!arguments.capture.empty()) return verify_captured(arguments);
    if (arguments.scene.file.empty()) throw UsageError("SCENE is required, or --capture; see raymill verify --help");
    RenderOptions options = arguments.device.options();
    options.planes = verify::ledger_planes();
    options.memory.pipelines = 1;  // no more are used
    Scene scene = arguments.scene.load();
    if (arguments.scene.size.empty()) shrink(scene.settings);
    print_warnings(scene.warnings);
    const Device device = arguments.device.open();
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    Renderer renderer(device, scene, bvh, options);
    const auto reports = verify::verify_frame(device, scene, renderer, arguments.options);

    fmt::print("{}: {} x {} pixels, {} spp, depth {}, {} primitives, on {}\n", scene.file, scene.settings.width,
               scene.settings.height, scene.settings.spp, scene.settings.depth, scene.primitive_count(),
               device.info.name);
    return conclude(reports);
}

}  // namespace

Command add_verify_command(CLI::App& app) {
    auto arguments = std::make_shared<VerifyArguments>();
    CLI::App& command = *app.add_subcommand(
        "verify", "Replay every kernel's queue through the scalar reference; show the first item that differs");
    arguments->scene.add_to(command)->required(false);
    command
        .add_option("--capture", arguments->capture,
                    "Compare the launch that render --capture wrote, in place of a whole frame; SCENE then says where "
                    "its scene is, if it has moved")
        ->type_name("FILE");
    command
        .add_option("--primitive-tests", arguments->options.primitive_tests,
                    "Intersections that the reference may try for each of intersect and shadow; beyond it, a spread "
                    "subset of the items is compared")
        ->type_name("N")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 60))
        ->capture_default_str();
    arguments->device.add_to(command);
    command.footer(
        "Renders about 64 x 64 pixels unless --size is given.\n\n"
        "Columns: items of the queue and how many were compared; the worst and the typical (median) error over its\n"
        "bound; items whose branch differs, and the largest distance of such a one from the border between the\n"
        "branches over its bound (below 1 both are right); items out of bounds.\n\n"
        "Examples:\n"
        "  raymill verify scenes/first-light.toml\n"
        "  raymill verify scenes/first-light.toml --spp 1 --kernel-dir my-kernels\n"
        "  raymill verify --capture queue.wave\n\n"
        "Exit status: 0 all within bounds; 1 something is not, or the device failed; 2 bad arguments or input.");
    return [arguments] { return verify_scene(*arguments); };
}

}  // namespace raymill
