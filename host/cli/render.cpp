// raymill render: a scene file goes in, a picture comes out.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>

#include "bvh/bvh.hpp"
#include "cli/aov.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "image/image.hpp"

namespace raymill {

namespace {

constexpr int interrupted_status = 130;

struct RenderArguments {
    SceneArguments scene;
    DeviceArguments device;
    std::string output;
    std::string aovs;
    bool half = false;
    bool stats = false;
    bool quiet = false;
};

std::string default_output(const std::string& scene_file) {
    return std::filesystem::path(scene_file).stem().string() + ".exr";
}

/// OpenGL-like clip space of the camera: x right, y up, in [-1, 1] over the image.
glm::dmat4 projection_matrix(const Camera& camera, const RenderSettings& settings) {
    const double aspect = static_cast<double>(settings.width) / settings.height;
    if (camera.projection == Projection::orthographic) {
        const double half = camera.height / 2;
        return glm::ortho(-half * aspect, half * aspect, -half, half, 1e-3, 1e6);
    }
    return glm::perspective(glm::radians(camera.fov), aspect, 1e-3, 1e6);
}

ImageMetadata metadata_of(const Scene& scene, double seconds) {
    const PixelWindow window = crop_window(scene.settings);
    ImageMetadata m;
    m.full_width = scene.settings.width;
    m.full_height = scene.settings.height;
    m.x0 = window.x0;
    m.y0 = window.y0;
    m.world_to_camera = glm::lookAt(scene.camera.eye, scene.camera.look_at, scene.camera.up);
    m.world_to_ndc = projection_matrix(scene.camera, scene.settings) * m.world_to_camera;
    m.samples_per_pixel = scene.settings.spp;
    m.render_seconds = seconds;
    m.scene_hash = scene.hash;
    m.scene_file = scene.file;
    m.version = RAYMILL_VERSION;
    return m;
}

void write_picture(const RenderArguments& arguments, const Scene& scene, Frame& frame,
                   const std::vector<std::string>& aovs) {
    const PixelWindow window = crop_window(scene.settings);
    const std::vector<ImageLayer> layers = aov_layers(frame, aovs);
    const Image image{window.width, window.height, std::move(frame.rgba)};
    if (image_format(arguments.output) == ImageFormat::png)
        write_png(arguments.output, image, scene.settings.exposure);
    else
        write_exr(arguments.output, image, layers, metadata_of(scene, frame.seconds),
                  arguments.half ? ExrPixels::half16 : ExrPixels::float32);
}

void warn_of_dropped(const BvhStatistics& statistics) {
    if (statistics.dropped_not_finite > 0)
        fmt::print(stderr, "warning: {} triangles have a vertex that is not finite and are left out\n",
                   statistics.dropped_not_finite);
}

void warn_of_film(const Frame& frame) {
    if (frame.not_a_number > 0)
        fmt::print(stderr, "warning: {} contributions were not a number and are left out\n", frame.not_a_number);
    if (frame.saturated > 0)
        fmt::print(stderr, "warning: {} contributions were brighter than the film holds and are cut\n", frame.saturated);
}

void print_statistics(const Frame& frame, const Renderer& renderer, const Bvh& bvh, double first_ray) {
    double busy = 0;
    for (const StageTime& stage : frame.stages) busy += stage.seconds;
    fmt::print(stderr, "{:<12}{:>10}{:>16}{:>12}{:>8}{:>10}\n", "stage", "launches", "items", "seconds", "share", "ns/item");
    for (const StageTime& stage : frame.stages)
        fmt::print(stderr, "{:<12}{:>10}{:>16}{:>12.4f}{:>7.1f}%{:>10.1f}\n", stage.stage, stage.launches, stage.items,
                   stage.seconds, 100 * stage.seconds / frame.seconds,
                   1e9 * stage.seconds / static_cast<double>(std::max<std::uint64_t>(stage.items, 1)));
    fmt::print(stderr, "{:<12}{:>10}{:>16}{:>12.4f}{:>7.1f}%\n", "host, launch", "", "", frame.seconds - busy,
               100 * (frame.seconds - busy) / frame.seconds);
    fmt::print(stderr, "rays: {} camera, {} secondary, {} shadow ({} blocked), in {} waves of at most {}\n",
               frame.rays.camera, frame.rays.secondary, frame.rays.shadow, frame.shadow_blocked, frame.waves,
               renderer.memory().queue_capacity);
    fmt::print(stderr, "hierarchy: {:.3f} s, first ray after {:.3f} s, film hash {:016x}\n", bvh.statistics.seconds,
               first_ray, frame.hash());
}

void print_closing_line(const RenderArguments& arguments, const Scene& scene, const Frame& frame) {
    const PixelWindow window = crop_window(scene.settings);
    const double rays = static_cast<double>(frame.rays.total());
    fmt::print(stderr, "{}: {} x {} pixels, {} spp, {} rays, {:.2f} s, {:.2f} Mrays/s\n", arguments.output,
               window.width, window.height, scene.settings.spp, frame.rays.total(), frame.seconds,
               rays / frame.seconds / 1e6);
}

int render(RenderArguments arguments) {
    const auto start = std::chrono::steady_clock::now();
    if (arguments.output.empty()) arguments.output = default_output(arguments.scene.file);
    const std::vector<std::string> aovs = parse_aovs(arguments.aovs);
    RenderOptions options = arguments.device.options();
    options.planes = aov_planes(aovs);
    if (image_format(arguments.output) == ImageFormat::png && (arguments.half || !aovs.empty()))
        throw UsageError(fmt::format("{}: a PNG has 8 bits a channel and no layers; give an output that ends in .exr",
                                     arguments.half ? "--half" : "--aov"));
    const Scene scene = arguments.scene.load();
    check_writable(arguments.output);
    if (!arguments.quiet) print_warnings(scene.warnings);

    const Device device = arguments.device.open();
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    if (!arguments.quiet) warn_of_dropped(bvh.statistics);
    Renderer renderer(device, scene, bvh, options);
    const double first_ray = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    InterruptGuard guard;
    ProgressBar bar(!arguments.quiet);
    const auto progress = [&](double share) {
        bar.show(share);
        return !guard.interrupted();
    };
    Frame frame = renderer.render(progress, arguments.stats);
    bar.clear();
    if (!arguments.quiet) warn_of_film(frame);
    if (arguments.stats) print_statistics(frame, renderer, bvh, first_ray);
    write_picture(arguments, scene, frame, aovs);
    if (!arguments.quiet) print_closing_line(arguments, scene, frame);
    if (frame.finished == 1) return 0;
    fmt::print(stderr, "interrupted: {:.0f}% of the samples are in {}\n", 100 * frame.finished, arguments.output);
    return interrupted_status;
}

}  // namespace

Command add_render_command(CLI::App& app) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App& command = *app.add_subcommand("render", "Render a scene or a bare model to an .exr or .png file");
    arguments->scene.add_to(command);
    command.add_option("-o,--output", arguments->output, "Picture to write; <scene>.exr in this folder by default")
        ->type_name("FILE");
    command
        .add_option("--aov", arguments->aovs,
                    "Layers of the EXR file: ambient, diffuse, specular, reflection, refraction, emission (their sum is "
                    "the picture), shadow, albedo, N, Z, P, id, depth, samples; all")
        ->type_name("LIST");
    command.add_flag("--half", arguments->half, "16-bit floats in the EXR file instead of 32-bit ones");
    arguments->device.add_to(command);
    command.add_flag("--stats", arguments->stats, "Print where the time went");
    command.add_flag("--quiet", arguments->quiet, "Print errors only");
    command.footer(
        "Examples:\n"
        "  raymill render scenes/first-light.toml -o first-light.png\n"
        "  raymill render model.obj --size 1280x720 --spp 16 -o model.exr\n"
        "  raymill render scene.toml --crop 0.25,0.75,0.25,0.75 --stats\n\n"
        "Exit status: 0 done; 1 the render failed; 2 bad arguments or bad input;\n"
        "130 interrupted, with what was rendered saved.");
    return [arguments] { return render(*arguments); };
}

}  // namespace raymill
