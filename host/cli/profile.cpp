// raymill profile: what queue capacity, work-group and threads do to a scene's time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "bvh/bvh.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/run_profile.hpp"
#include "cli/sweep.hpp"
#include "common/files.hpp"
#include "common/output_error.hpp"
#include "device/caches.hpp"
#include "profile/sweep_output.hpp"

namespace raymill {

namespace {

namespace fs = std::filesystem;

constexpr int interrupted_status = 130;
constexpr int images_differ = 1;
constexpr double wanted_seconds = 1;  // of a frame
constexpr int most_chosen_samples = 4096;

struct ProfileArguments {
    SceneArguments scene;
    DeviceArguments device;
    std::string output;
    std::string queue_capacities = "1k,2k,4k,8k,16k,32k,64k,128k,256k,512k,1M,2M,4M";
    std::string work_groups = "auto";
    std::string threads = "all";
    int repeats = 5;
    bool quiet = false;

    SweepLists lists() const {
        return {queue_capacity_flag.parse_list(queue_capacities), work_group_flag.parse_list(work_groups),
                threads_flag.parse_list(threads), repeats};
    }
};

/// The folder of the report. It is made if it is missing, and removed again if nothing came into it.
class OutputFolder {
  public:
    explicit OutputFolder(const std::string& path) : path_(path) {
        std::error_code error;
        if (!fs::is_directory(path_, error)) made_ = fs::create_directory(path_, error);
        if (error) throw write_error(path, error.value());
        for (const char* name : {"profile.csv", "profile.json", "trace.json", "report.html"})
            check_writable(file(name));
    }
    ~OutputFolder() {
        std::error_code not_empty;
        if (made_) fs::remove(path_, not_empty);
    }
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    std::string file(const char* name) const { return (path_ / name).string(); }

  private:
    fs::path path_;
    bool made_ = false;
};

/// Samples per pixel with which a frame takes about as long as wanted: timed with ever more samples until the time is
/// long enough to tell. Nothing if an interrupt comes; `scene` is then as it was.
std::optional<int> choose_samples(const Sweeper& sweeper, Scene& scene) {
    constexpr double long_enough = wanted_seconds / 8;
    constexpr int step = 8;
    const int scene_samples = scene.settings.spp;
    for (int spp = 1;; spp = std::min(step * spp, most_chosen_samples)) {
        scene.settings.spp = spp;
        const std::optional<double> seconds = sweeper.time_frame();
        scene.settings.spp = scene_samples;
        if (!seconds) return std::nullopt;
        if (*seconds < long_enough && spp < most_chosen_samples) continue;
        return std::clamp(static_cast<int>(std::lround(spp * wanted_seconds / *seconds)), 1, most_chosen_samples);
    }
}

profile::Sweep describe(const Scene& scene, const Device& device, int scene_samples, bool samples_chosen) {
    const PixelWindow window = crop_window(scene.settings);
    profile::Sweep sweep;
    sweep.version = RAYMILL_VERSION;
    sweep.scene = scene.file;
    sweep.width = window.width;
    sweep.height = window.height;
    sweep.depth = scene.settings.depth;
    sweep.samples_per_pixel = scene.settings.spp;
    sweep.scene_samples_per_pixel = scene_samples;
    sweep.samples_chosen = samples_chosen;
    sweep.primitives = scene.primitive_count();
    sweep.device = device.info.name;
    sweep.platform = device.info.platform;
    sweep.driver = device.info.driver;
    sweep.device_memory = device.info.global_memory;
    if (device.info.type == "CPU")
        for (const ProcessorCache& cache : processor_caches())
            sweep.caches.push_back({cache.name, cache.bytes, cache.sharers});
    else if (device.info.cache > 0)
        sweep.caches.push_back({"cache", device.info.cache, device.info.compute_units});
    return sweep;
}

void write_files(const OutputFolder& folder, const profile::Sweep& sweep, const profile::RunProfile& whole) {
    const nlohmann::ordered_json json = profile::to_json(sweep);
    write_text_atomically(folder.file("profile.json"), [&](std::ostream& out) {
        out << json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    });
    write_text_atomically(folder.file("profile.csv"), [&](std::ostream& out) { profile::write_csv(out, sweep); });
    write_trace(folder.file("trace.json"), sweep.timeline ? *sweep.timeline : whole);
    write_text_atomically(folder.file("report.html"), [&](std::ostream& out) { profile::write_report(out, json); });
}

/// The run without any frame: what the trace shows of a sweep that was interrupted before any was measured.
profile::RunProfile whole_run(const RunClock& clock, const profile::Sweep& sweep, std::int64_t start) {
    profile::RunProfile run;
    run.scene = sweep.scene;
    run.device = sweep.device;
    run.spans = clock.timeline.spans();
    run.start = start;
    return run;
}

std::string default_output(const std::string& scene_file) {
    return fs::path(scene_file).stem().string() + "-profile";
}

int profile_scene(const ProfileArguments& arguments) {
    const std::int64_t start = profile::now();
    RunClock clock;
    const SweepLists lists = arguments.lists();
    arguments.device.options();  // says what is wrong with them before anything is loaded
    Scene scene = clock.timeline.measure("load scene", [&] { return arguments.scene.load(); });
    const int scene_samples = scene.settings.spp;
    if (!arguments.quiet) print_warnings(scene.warnings);
    const InterruptGuard guard;  // from here on there is a folder that must not stay empty
    const OutputFolder folder(arguments.output.empty() ? default_output(arguments.scene.file) : arguments.output);
    const Bvh bvh = clock.timeline.measure("build hierarchy", [&] {
        return build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    });

    ProgressBar bar(!arguments.quiet);
    Sweeper sweeper(arguments.device, lists, scene, bvh, guard, bar);
    const std::optional<int> chosen = arguments.scene.spp ? std::nullopt : choose_samples(sweeper, scene);
    if (chosen) {
        scene.settings.spp = *chosen;
        if (!arguments.quiet)
            fmt::print(stderr,
                       "frames of {} spp, so that one takes about a second (the scene has {}; --spp changes it)\n",
                       scene.settings.spp, scene_samples);
    }
    profile::Sweep sweep = describe(scene, sweeper.device(), scene_samples, chosen.has_value());
    clock.timeline.measure("sweep", [&] { sweeper.run(sweep); });
    write_files(folder, sweep, whole_run(clock, sweep, start));

    fmt::print("{}", profile::table(sweep));
    if (!arguments.quiet) fmt::print(stderr, "{}: look at it with a browser\n", folder.file("report.html"));
    if (!sweep.complete) return interrupted_status;
    return profile::find(sweep).same_image() ? 0 : images_differ;
}

}  // namespace

Command add_profile_command(CLI::App& app) {
    auto arguments = std::make_shared<ProfileArguments>();
    CLI::App& command = *app.add_subcommand(
        "profile", "Render a scene with one queue capacity, work-group and number of threads after another");
    arguments->scene.add_to(command);
    command
        .add_option("-o,--output", arguments->output, "Folder of the report; <scene>-profile in this one by default")
        ->type_name("DIR");
    command.add_option("--queue-capacity", arguments->queue_capacities, "Rays of a batch; k is 1024, M 1024 k")
        ->type_name("LIST")
        ->capture_default_str();
    command.add_option("--work-group", arguments->work_groups, "Work-items of a group; auto is what suits each stage")
        ->type_name("LIST")
        ->capture_default_str();
    command.add_option("--threads", arguments->threads, "Compute units to use; all is every one")
        ->type_name("LIST")
        ->capture_default_str();
    command.add_option("--repeats", arguments->repeats, "Timed frames of each setting; their median counts")
        ->type_name("N")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    arguments->device.add_fixed_to(command);
    arguments->device.add_pipelines_to(command);
    command.add_flag("--quiet", arguments->quiet, "Print the table only");
    command.footer(
        "Writes profile.csv, profile.json, trace.json (for Perfetto and chrome://tracing) and report.html.\n"
        "Without --spp, samples are chosen so that a frame takes about a second.\n\n"
        "Examples:\n"
        "  raymill profile scenes/first-light.toml\n"
        "  raymill profile scene.toml --queue-capacity 1k,16k,64k,1M --work-group auto,1,64 --threads 1,2 -o sweep\n\n"
        "Exit status: 0 done; 1 the sweep failed, or images differ; 2 bad arguments or bad input;\n"
        "130 interrupted, with what was measured saved.");
    return [arguments] { return profile_scene(*arguments); };
}

}  // namespace raymill
