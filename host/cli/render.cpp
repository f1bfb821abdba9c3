// raymill render: a scene file goes in, a picture comes out.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "bvh/bvh.hpp"
#include "cli/aov.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/frame_captures.hpp"
#include "cli/progress.hpp"
#include "cli/run_profile.hpp"
#include "common/files.hpp"
#include "image/image.hpp"
#include "profile/table.hpp"

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
    std::string stats_file;
    std::string trace_file;
    std::vector<std::string> captures;
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
                  arguments.half ? ExrPixels::half16 : ExrPixels::float32, arguments.device.threads);
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
        fmt::print(stderr, "warning: {} contributions were brighter than the film holds and are cut\n",
                   frame.saturated);
}

void print_closing_line(const RenderArguments& arguments, const Scene& scene, const Frame& frame) {
    const PixelWindow window = crop_window(scene.settings);
    const double rays = static_cast<double>(frame.rays.total());
    fmt::print(stderr, "{}: {} x {} pixels, {} spp, {} rays, {:.2f} s, {:.2f} Mrays/s\n", arguments.output,
               window.width, window.height, scene.settings.spp, frame.rays.total(), frame.seconds,
               rays / frame.seconds / 1e6);
}

profile::Detail detail_of(const RenderArguments& arguments) {
    if (!arguments.stats_file.empty() || !arguments.trace_file.empty()) return profile::Detail::launches;
    return arguments.stats ? profile::Detail::totals : profile::Detail::none;
}

/// Throws UsageError where one file would replace another or the scene, OutputError where one could not be written.
void check_outputs(const RenderArguments& arguments, const FrameCaptures& captures) {
    std::set<std::filesystem::path> seen;
    std::vector<std::string> files = captures.files();
    files.insert(files.end(), {arguments.output, arguments.stats_file, arguments.trace_file});
    for (const std::string& file : files) {
        if (file.empty()) continue;
        if (!seen.insert(std::filesystem::path(file).lexically_normal()).second)
            throw UsageError(
                fmt::format("{} is to hold two things at once: give -o, --stats-json, --trace and --capture files of "
                            "their own",
                            file));
        check_keeps(arguments.scene.file, file);
        check_writable(file);
    }
}

void report(const RenderArguments& arguments, const profile::RunProfile& run) {
    if (arguments.stats) fmt::print(stderr, "{}", profile::table(run));
    if (!arguments.stats_file.empty()) write_statistics(arguments.stats_file, run);
    if (!arguments.trace_file.empty()) write_trace(arguments.trace_file, run);
}

/// Shows progress; an interrupt ends the frame with what is rendered.
Frame render_frame(const RenderArguments& arguments, Renderer& renderer) {
    InterruptGuard guard;
    ProgressBar bar(!arguments.quiet);
    const auto progress = [&](double share) {
        bar.show(share);
        return !guard.interrupted();
    };
    return renderer.render(progress, detail_of(arguments));
}

int render(RenderArguments arguments) {
    RunClock clock;
    FrameCaptures captures(arguments.captures);
    if (arguments.output.empty()) arguments.output = default_output(arguments.scene.file);
    const std::vector<std::string> aovs = parse_aovs(arguments.aovs);
    RenderOptions options = arguments.device.options();
    options.planes = aov_planes(aovs);
    options.keep_sums = !aovs.empty();
    // What is timed or captured goes wave by wave.
    if (detail_of(arguments) != profile::Detail::none || !arguments.captures.empty()) options.memory.pipelines = 1;
    if (image_format(arguments.output) == ImageFormat::png && (arguments.half || !aovs.empty()))
        throw UsageError(fmt::format("{}: a PNG has 8 bits a channel and no layers; give an output that ends in .exr",
                                     arguments.half ? "--half" : "--aov"));
    const Scene scene = clock.timeline.measure("load scene", [&] { return arguments.scene.load(); });
    captures.check(scene);
    check_outputs(arguments, captures);
    if (!arguments.quiet) print_warnings(scene.warnings);

    const Device device = clock.timeline.measure("open device", [&] { return arguments.device.open(); });
    const Bvh bvh = clock.timeline.measure("build hierarchy", [&] {
        return build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    });
    if (!arguments.quiet) warn_of_dropped(bvh.statistics);
    Renderer renderer(device, scene, bvh, options);
    captures.observe(device, renderer);
    Frame frame =
        clock.timeline.measure(std::string(profile::render_span), [&] { return render_frame(arguments, renderer); });
    if (!arguments.quiet) warn_of_film(frame);
    if (!arguments.captures.empty())
        clock.timeline.measure("write captures", [&] { captures.write(scene, renderer, frame, arguments.quiet); });
    clock.timeline.measure("write picture", [&] { write_picture(arguments, scene, frame, aovs); });
    if (detail_of(arguments) != profile::Detail::none)
        report(arguments, clock.read(scene, device, options, renderer, frame));
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
        .add_option(
            "--aov", arguments->aovs,
            "Layers of the EXR file: ambient, diffuse, specular, reflection, refraction, emission (their sum is "
            "the picture), shadow, albedo, N, Z, P, id, depth, samples; all")
        ->type_name("LIST");
    command.add_flag("--half", arguments->half, "16-bit floats in the EXR file instead of 32-bit ones");
    arguments->device.add_to(command);
    arguments->device.add_pipelines_to(command);
    command.add_flag("--stats", arguments->stats,
                     "Print what each stage did and where the time went, of a frame that goes wave by wave");
    command.add_option("--stats-json", arguments->stats_file, "The same for programs, with every launch")
        ->type_name("FILE");
    command.add_option("--trace", arguments->trace_file, "Timeline of the run for Perfetto and chrome://tracing")
        ->type_name("FILE");
    command
        .add_option("--capture", arguments->captures,
                    "Write the input queue of one launch of a stage, for raymill replay and verify; more than once "
                    "for several")
        ->type_name("DEPTH[:LAUNCH],STAGE,FILE")
        ->allow_extra_args(false);
    command.add_flag("--quiet", arguments->quiet, "Print errors only");
    command.footer(
        "Examples:\n"
        "  raymill render scenes/first-light.toml -o first-light.png\n"
        "  raymill render model.obj --size 1280x720 --spp 16 -o model.exr\n"
        "  raymill render scene.toml --crop 0.25,0.75,0.25,0.75 --stats\n"
        "  raymill render scene.toml --capture 1,intersect,queue.wave\n\n"
        "--capture: STAGE is generate, intersect, shade, shadow or secondary, working on rays of DEPTH. LAUNCH counts\n"
        "the launches of that stage at that depth from 0 on; without it, the fullest is written: that which finds the\n"
        "most hits, or pushes the most rays, and of several such, that with the most items in its queue.\n"
        "With --capture, --stats, --stats-json or --trace the frame goes wave by wave, as by --pipelines 1: slower.\n\n"
        "Exit status: 0 done; 1 the render failed; 2 bad arguments or bad input;\n"
        "130 interrupted, with what was rendered saved.");
    return [arguments] { return render(*arguments); };
}

}  // namespace raymill
