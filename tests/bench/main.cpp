// raymill_bench: Raymill's traversal beside Embree's on the same triangles and rays, interleaved in one run.
// Exit status: 0 measured; 1 the two sides disagree, or something failed; 2 bad arguments or input.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>

#include "report.hpp"

namespace {

using namespace raymill;
using namespace raymill::bench;

constexpr int failed = 1;
constexpr int bad_input = 2;

struct Arguments {
    std::vector<std::string> scenes;
    std::optional<double> triangles;  // 1e6, or 1e7 for scaling
    bool scaling = false;
    std::string mesh;
    std::vector<double> eye, look_at;
    std::optional<double> fov;
    std::string size;
    std::string traversal = "all";
    std::vector<std::string> kernel_dirs;
    std::string quality = "both";
    std::string device;
    std::string json;
    bool list = false;
    MeasureOptions measure;
};

const std::map<std::string, Clock> clocks = {{"wall", Clock::wall}, {"processor", Clock::processor}};

void add_options(CLI::App& app, Arguments& a) {
    std::vector<std::string> names;
    for (const Recipe& recipe : recipes()) names.push_back(recipe.name);
    app.add_option("--scene", a.scenes, "Scenes that the program makes; all of them without this and --mesh")
        ->check(CLI::IsMember(names));
    app.add_flag("--list", a.list, "Say what the scenes are");
    app.add_option("--triangles", a.triangles,
                   "Triangles of each made scene, about (default 1e6); the largest for --scaling (default 1e7)")
        ->check(CLI::Range(100.0, 5e7));
    CLI::Option* scaling =
        app.add_flag("--scaling", a.scaling,
                     "Instead: how the time of a ray grows with the made scenes, threads, queues and images");
    scaling->excludes(app.add_option("--mesh", a.mesh, "A model or a scene file")->check(CLI::ExistingFile));
    app.add_option("--eye", a.eye, "Camera of --mesh: x y z; without it the model is framed")->expected(3);
    app.add_option("--look-at", a.look_at, "What it looks at: x y z")->expected(3);
    app.add_option("--fov", a.fov, "Vertical field of view in degrees")->check(CLI::Range(1.0, 170.0));
    app.add_option("--size", a.size, "Camera rays, WIDTHxHEIGHT, rounded up to tiles of 8 (default 1024x768)");
    app.add_option(
           "--rays", a.measure.sets,
           "Sets of rays, as in S,A: P camera, S to a point light, A to an area light, R mirrored, T through glass, "
           "D diffuse; all of them without this")
        ->delimiter(',')
        ->check(CLI::IsMember({"P", "S", "A", "R", "T", "D"}));
    app.add_option("--rounds", a.measure.rounds, "Times that each variant runs (11 and more for medians)")
        ->check(CLI::Range(1, 1000));
    app.add_option("--builds", a.measure.builds, "Times that each hierarchy is built")->check(CLI::Range(1, 100));
    app.add_option("--traversal", a.traversal, "Which of our kernels")
        ->check(CLI::IsMember({"automatic", "packet", "single", "all"}));
    app.add_option("--kernel-dir", a.kernel_dirs, "Folders of other kernels, to be measured beside the project's")
        ->check(CLI::ExistingDirectory)
        ->excludes(scaling);
    static const std::map<std::string, BvhQuality> qualities = {{"fast", BvhQuality::fast}, {"high", BvhQuality::high}};
    app.add_option("--bvh", a.measure.bvh, "Our hierarchy, fast or high")
        ->transform(CLI::CheckedTransformer(qualities).description(""));
    app.add_option("--quality", a.quality, "Of Embree's hierarchy")->check(CLI::IsMember({"medium", "high", "both"}));
    app.add_option("--device", a.device, "OpenCL device: index or part of its name");
    app.add_option("--threads", a.measure.threads, "Of either side; 0 for all")->check(CLI::Range(0u, 1024u));
    app.add_option("--clock", a.measure.clock, "wall, or processor: time of all threads, for a busy machine")
        ->transform(CLI::CheckedTransformer(clocks));
    app.add_flag("--robust", a.measure.robust, "Embree's watertight mode (ours always is)");
    app.add_option("--json", a.json, "Write the numbers to this file as well");
}

void parse_size(const std::string& size, MeasureOptions& options) {
    if (size.empty()) return;
    int width = 0, height = 0, end = 0;
    if (std::sscanf(size.c_str(), "%5dx%5d%n", &width, &height, &end) != 2 || end != static_cast<int>(size.size()) ||
        width < 1 || height < 1)
        throw UsageError(fmt::format("--size {}: expected WIDTHxHEIGHT", size));
    options.width = (width + TILE - 1) / TILE * TILE;
    options.height = (height + TILE - 1) / TILE * TILE;
}

BenchScene load_mesh(const Arguments& a) {
    BenchScene bench = load_bench_scene(a.mesh);
    if (bench.scene.primitive_count() == 0) throw UsageError(fmt::format("{}: there is nothing to hit", a.mesh));
    Camera& camera = bench.scene.camera;
    if (!a.eye.empty()) camera.eye = {a.eye[0], a.eye[1], a.eye[2]};
    if (!a.look_at.empty()) camera.look_at = {a.look_at[0], a.look_at[1], a.look_at[2]};
    if (a.fov) camera.fov = *a.fov;
    if (glm::length(glm::cross(camera.look_at - camera.eye, camera.up)) == 0)
        throw UsageError("--eye and --look-at: the camera looks nowhere, or straight up or down");
    return bench;
}

std::vector<Traversal> traversals(const std::string& choice) {
    if (choice == "automatic") return {Traversal::automatic};
    if (choice == "packet") return {Traversal::packet};
    if (choice == "single") return {Traversal::single};
    return {Traversal::automatic, Traversal::packet, Traversal::single};
}

std::vector<Quality> qualities(const std::string& choice) {
    if (choice == "medium") return {Quality::medium};
    if (choice == "high") return {Quality::high};
    return {Quality::medium, Quality::high};
}

bool is_wanted(const Arguments& a, const std::string& scene) {
    if (a.scenes.empty()) return a.mesh.empty();
    return std::find(a.scenes.begin(), a.scenes.end(), scene) != a.scenes.end();
}

Circumstances circumstances_of(const Arguments& a, const DeviceInfo& device) {
    return {device.name, device.driver, device.compute_units, RTC_VERSION_STRING, a.measure};
}

void run_scaling(const Arguments& a) {
    const double largest = a.triangles.value_or(1e7);
    if (largest < 1e4) throw UsageError("--scaling: give at least 10000 --triangles");
    std::vector<ScalingTable> tables;
    for (const Recipe& recipe : recipes())
        if (is_wanted(a, recipe.name))
            measure_scaling(recipe, {a.measure, a.device, largest}, [&](const ScalingTable& table) {
                tables.push_back(table);
                print_scaling(table);
                std::fflush(stdout);
            });
    if (!a.json.empty())
        write_json(a.json, circumstances_of(a, open_device(a.device, a.measure.threads).info), {}, tables);
}

/// Whether both sides agreed everywhere.
bool run(const Arguments& a) {
    const RaymillKernels kernels(a.device, a.measure.threads, traversals(a.traversal), a.kernel_dirs);
    const Circumstances circumstances = circumstances_of(a, kernels.device().info);
    print_heading(circumstances);
    std::vector<SceneResult> results;
    bool agreed = true;
    const auto add = [&](const BenchScene& bench) {
        results.push_back(measure(bench, kernels, a.measure));
        print_scene(results.back());
        std::fflush(stdout);
        if (results.back().worst_difference() <= ALLOWED_DIFFERENCE) return;
        agreed = false;
        fmt::print(stderr, "raymill_bench: {}: the results of {:.2e} of a set's rays differ, more than {:.0e}\n",
                   bench.name, results.back().worst_difference(), ALLOWED_DIFFERENCE);
    };
    for (const Recipe& recipe : recipes())
        if (is_wanted(a, recipe.name)) add(recipe.make(a.triangles.value_or(1e6)));
    if (!a.mesh.empty()) add(load_mesh(a));
    print_summary(results);
    if (!a.json.empty()) write_json(a.json, circumstances, results, {});
    return agreed;
}

int fail(int status, const char* message) {
    fmt::print(stderr, "raymill_bench: {}\n", message);
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures Raymill's traversal beside Embree's, on the same triangles and rays.", "raymill_bench");
    Arguments arguments;
    try {
        add_options(app, arguments);
        app.parse(argc, argv);
        if (arguments.list) {
            for (const Recipe& recipe : recipes()) fmt::print("{:<10} {}\n", recipe.name, recipe.description);
            return 0;
        }
        parse_size(arguments.size, arguments.measure);
        arguments.measure.qualities = qualities(arguments.quality);
        // As the program does: workers that stay where they are. It must be set before OpenCL is loaded.
        setenv("POCL_AFFINITY", "1", 0);
        std::optional<tbb::global_control> limit;
        if (arguments.measure.threads > 0)
            limit.emplace(tbb::global_control::max_allowed_parallelism, arguments.measure.threads);
        if (arguments.scaling) {
            run_scaling(arguments);
            return 0;
        }
        return run(arguments) ? 0 : failed;
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return fail(bad_input, error.what());
    } catch (const UsageError& error) {
        return fail(bad_input, error.what());
    } catch (const SceneError& error) {
        return fail(bad_input, error.what());
    } catch (const std::exception& error) {
        return fail(failed, error.what());
    }
}
