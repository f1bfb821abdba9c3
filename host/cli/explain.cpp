// raymill explain: why a pixel has the colour it has.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <ostream>

#include "bvh/bvh.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "common/files.hpp"
#include "verify/explanation.hpp"

namespace raymill {

namespace {

constexpr int sums_differ = 1;

struct ExplainArguments {
    SceneArguments scene;
    DeviceArguments device;
    std::string pixel;
    std::optional<std::uint32_t> sample;
    std::string obj;
};

/// "12,34" to a pixel of the image. Throws UsageError.
std::pair<int, int> parse_pixel(const std::string& text, const RenderSettings& settings) {
    int x = 0, y = 0;
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, x);
    const bool comma = first.ec == std::errc{} && first.ptr != end && *first.ptr == ',';
    const auto second = comma ? std::from_chars(first.ptr + 1, end, y) : first;
    if (!comma || second.ec != std::errc{} || second.ptr != end)
        throw UsageError(fmt::format("--pixel {}: give column and row from the top left, as in 12,34", text));
    if (x < 0 || y < 0 || x >= settings.width || y >= settings.height)
        throw UsageError(fmt::format("--pixel {}: the image has {} x {} pixels, columns 0 to {} and rows 0 to {}", text,
                                     settings.width, settings.height, settings.width - 1, settings.height - 1));
    return {x, y};
}

/// How far to draw a ray that hits nothing: as far as the camera and the scene reach.
double escape_length(const Scene& scene, const Bvh& bvh) {
    const double view = glm::length(scene.camera.look_at - scene.camera.eye);
    const glm::vec3 extent = bvh.bounds.upper - bvh.bounds.lower;
    return bvh.nodes.empty() ? 2 * view : std::max(2 * view, double{glm::length(extent)});
}

int explain(const ExplainArguments& arguments) {
    if (!arguments.scene.crop.empty()) throw UsageError("--crop: explain takes one pixel, by --pixel");
    RenderOptions options = arguments.device.options();
    Scene scene = arguments.scene.load();
    const auto [x, y] = parse_pixel(arguments.pixel, scene.settings);
    if (arguments.sample && *arguments.sample >= static_cast<std::uint32_t>(scene.settings.spp))
        throw UsageError(fmt::format("--sample {}: the pixel has {} samples, counted from 0", *arguments.sample,
                                     scene.settings.spp));
    if (!arguments.obj.empty()) {
        check_keeps(arguments.scene.file, arguments.obj);
        check_writable(arguments.obj);
    }
    print_warnings(scene.warnings);
    verify::crop_to_pixel(scene.settings, x, y);
    options.memory.pipelines = 1;  // no more are used
    // One pixel needs no more than this; the queues of a whole frame would only take time to set up.
    if (options.memory.queue_capacity == 0)
        options.memory.queue_capacity = static_cast<std::uint64_t>(std::clamp<int>(scene.settings.spp, CHUNK, 1 << 16));

    const Device device = arguments.device.open();
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    Renderer renderer(device, scene, bvh, options);
    const verify::RayTree tree = verify::trace_pixel(device, renderer);
    const reference::Tracer tracer(scene);
    const verify::Truth truth{scene, tracer};
    fmt::print("{}: pixel ({}, {}) of {} x {}, {} spp, depth {}\n", scene.file, x, y, scene.settings.width,
               scene.settings.height, scene.settings.spp, scene.settings.depth);
    fmt::print("{}", verify::explanation_text(truth, tree, arguments.sample));
    if (!arguments.obj.empty())
        write_text_atomically(arguments.obj, [&](std::ostream& out) {
            out << verify::ray_lines(truth, tree, arguments.sample, escape_length(scene, bvh));
        });
    return tree.sums_agree() ? 0 : sums_differ;
}

}  // namespace

Command add_explain_command(CLI::App& app) {
    auto arguments = std::make_shared<ExplainArguments>();
    CLI::App& command =
        *app.add_subcommand("explain", "Tell a pixel's ray tree in words and numbers: why it has its colour");
    arguments->scene.add_to(command);
    command.add_option("--pixel", arguments->pixel, "Column and row from the top left, counted from 0")
        ->type_name("X,Y")
        ->required();
    command.add_option("--sample", arguments->sample, "Tell only this camera sample of the pixel")->type_name("N");
    command.add_option("--obj", arguments->obj, "Write the rays as lines of an OBJ file")->type_name("FILE");
    arguments->device.add_to(command);
    command.footer(
        "What each ray adds is what the kernels added to the film; their sum is compared with the film's pixel, to "
        "the\n"
        "last integer. Angles, attenuation and the like come from the double-precision reference on the same rays.\n\n"
        "Examples:\n"
        "  raymill explain scenes/first-light.toml --pixel 480,270 --spp 1\n"
        "  raymill explain scenes/first-light.toml --pixel 480,270 --sample 0 --obj rays.obj\n\n"
        "Exit status: 0 done; 1 the sum is not the film's pixel, or the device failed; 2 bad arguments or bad input.");
    return [arguments] { return explain(*arguments); };
}

}  // namespace raymill
