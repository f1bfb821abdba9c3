// raymill_frames: whole frames beside a tracer of the same algorithm on Embree, interleaved in one run.
// Exit status: 0 measured; 1 pictures differ, or something failed; 2 bad arguments or input.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/error.hpp"
#include "frames/picture.hpp"
#include "frames/tracer.hpp"
#include "image/image.hpp"
#include "profile/statistics.hpp"
#include "profile/stopwatch.hpp"
#include "wavefront/renderer.hpp"

namespace {

using namespace raymill;
using namespace raymill::bench;
using profile::Clock;
using profile::geometric_mean;
using profile::Quartiles;
using profile::quartiles;
using profile::seconds_of;

constexpr int failed = 1;
constexpr int bad_input = 2;

struct Arguments {
    std::vector<std::string> scenes;
    int rounds = 11;
    int spp = 0;
    std::uint64_t min_rays = 100000;
    unsigned threads = 0;
    Clock clock = Clock::wall;
    std::string device;
    std::string pictures;
    std::string json;
};

/// A frame of both sides. Not measured where `left_out` says why.
struct FrameResult {
    std::string scene;
    std::string left_out;
    std::uint64_t rays = 0;
    PictureDifference difference;
    Quartiles raymill, embree;  // seconds
    Quartiles ratio;            // Embree's time over ours, round by round
};

const std::map<std::string, Clock> clocks = {{"wall", Clock::wall}, {"processor", Clock::processor}};

void add_options(CLI::App& app, Arguments& a) {
    app.add_option("scenes", a.scenes,
                   "Scene files or models; without any, all of the project's, and the terrain if it was built")
        ->check(CLI::ExistingFile);
    app.add_option("--rounds", a.rounds, "Times that each side renders (11 and more for medians)")
        ->check(CLI::Range(1, 1000));
    app.add_option("--spp", a.spp, "Samples a pixel instead of the scene's")->check(CLI::Range(1, 65536));
    app.add_option("--min-rays", a.min_rays, "Frames of fewer rays are left out");
    app.add_option("--threads", a.threads, "Of either side; 0 for all")->check(CLI::Range(0u, 1024u));
    app.add_option("--clock", a.clock, "wall, or processor: time of all threads, for a busy machine")
        ->transform(CLI::CheckedTransformer(clocks));
    app.add_option("--device", a.device, "OpenCL device: index or part of its name");
    app.add_option("--pictures", a.pictures, "Write both pictures of each scene into this folder, as PNG")
        ->check(CLI::ExistingDirectory);
    app.add_option("--json", a.json, "Write the numbers to this file as well");
}

void time_rounds(Renderer& renderer, const EmbreeTracer& tracer, const Arguments& a, FrameResult& result) {
    std::vector<double> ours, theirs, ratios;
    for (int round = 0; round < a.rounds; ++round) {
        ours.push_back(seconds_of([&] { renderer.render(); }, a.clock));
        theirs.push_back(seconds_of([&] { tracer.render(); }, a.clock));
        ratios.push_back(theirs.back() / ours.back());
    }
    result.raymill = quartiles(ours);
    result.embree = quartiles(theirs);
    result.ratio = quartiles(ratios);
}

void write_pictures(const Arguments& a, const Scene& scene, const Frame& frame, const std::vector<float>& theirs) {
    if (a.pictures.empty()) return;
    const PixelWindow window = crop_window(scene.settings);
    const auto file = [&](const char* side) {
        const auto name = fmt::format("{}-{}.png", std::filesystem::path(scene.file).stem().string(), side);
        return (std::filesystem::path(a.pictures) / name).string();
    };
    write_png(file("raymill"), {window.width, window.height, frame.rgba}, scene.settings.exposure);
    write_png(file("embree"), {window.width, window.height, theirs}, scene.settings.exposure);
}

/// Why no tracer could render the scene alike; empty where one can.
std::string incomparable(const Scene& scene) {
    if (scene.settings.shadow_offset == ShadowOffset::none) return "without an offset, rounding makes the picture";
    if (scene.settings.integrator != Integrator::whitted) return "of another integrator";
    if (film_pixels(scene) == 0) return "no pixels";
    return {};
}

FrameResult measure_frame(const Arguments& a, const Device& device, const std::string& file) {
    Scene scene = load_scene(file);
    if (a.spp > 0) scene.settings.spp = a.spp;
    FrameResult result;
    result.scene = std::filesystem::path(file).stem().string();
    result.left_out = incomparable(scene);
    if (!result.left_out.empty()) return result;

    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, {a.threads});
    RenderOptions options;
    options.keep_sums = false;  // as raymill render does: the picture is all that either side hands back
    Renderer renderer(device, scene, bvh, options);
    const Frame frame = renderer.render();  // compiles the kernels, too
    result.rays = frame.rays.total();
    if (result.rays < a.min_rays) {
        result.left_out = "too few rays";
        return result;
    }
    const EmbreeTracer tracer(scene, a.threads);
    const std::vector<float> theirs = tracer.render();
    write_pictures(a, scene, frame, theirs);
    result.difference = difference(frame.rgba, theirs);
    if (result.difference.allowed())
        time_rounds(renderer, tracer, a, result);
    else
        result.left_out = "PICTURES DIFFER";
    return result;
}

void print_result(const FrameResult& r) {
    const std::string difference = fmt::format("{:.1e} mean, {:.1e} of pixels", r.difference.mean, r.difference.pixels);
    if (!r.left_out.empty()) {
        fmt::print("{:<32} {:>6.1f} M  {:<47} {}\n", r.scene, 1e-6 * static_cast<double>(r.rays), r.left_out,
                   r.rays > 0 ? difference : "");
    } else {
        fmt::print("{:<32} {:>6.1f} M  {:>8.4f} s {:>8.4f} s   {:5.2f} {:<16} {}\n", r.scene,
                   1e-6 * static_cast<double>(r.rays), r.raymill.median, r.embree.median, r.ratio.median,
                   fmt::format("[{:.2f} {:.2f}]", r.ratio.lower, r.ratio.upper), difference);
    }
    std::fflush(stdout);
}

void print_summary(const std::vector<FrameResult>& results) {
    std::vector<double> ratios;
    const FrameResult* worst = nullptr;
    for (const FrameResult& r : results) {
        if (!r.left_out.empty()) continue;
        ratios.push_back(r.ratio.median);
        if (!worst || r.ratio.median < worst->ratio.median) worst = &r;
    }
    if (ratios.empty()) return;
    fmt::print("\n{} scenes: geometric mean {:.2f}, worst {:.2f} ({})\n", ratios.size(), geometric_mean(ratios),
               worst->ratio.median, worst->scene);
}

nlohmann::ordered_json json_of(const Quartiles& q) {
    return {{"median", q.median}, {"lower_quartile", q.lower}, {"upper_quartile", q.upper}};
}

void write_json(const Arguments& a, const Device& device, const std::vector<FrameResult>& results) {
    nlohmann::ordered_json all = {{"device", device.info.name},
                                  {"driver", device.info.driver},
                                  {"compute_units", device.info.compute_units},
                                  {"embree", RTC_VERSION_STRING},
                                  {"rounds", a.rounds},
                                  {"threads", a.threads},
                                  {"clock", a.clock == Clock::wall ? "wall" : "processor"},
                                  {"frames", nlohmann::ordered_json::array()}};
    for (const FrameResult& r : results) {
        nlohmann::ordered_json frame = {{"scene", r.scene}, {"rays", r.rays}};
        frame["difference"] = {{"mean", r.difference.mean}, {"pixels", r.difference.pixels}};
        if (!r.left_out.empty()) {
            frame["left_out"] = r.left_out;
        } else {
            frame["raymill_seconds"] = json_of(r.raymill);
            frame["embree_seconds"] = json_of(r.embree);
            frame["ratio"] = json_of(r.ratio);
        }
        all["frames"].push_back(frame);
    }
    std::ofstream out(a.json);
    out << all.dump(2) << '\n';
    out.close();
    if (!out) throw std::runtime_error(fmt::format("cannot write {}", a.json));
}

/// The scene files of the project's folders, each folder in the order of names.
std::vector<std::string> project_scenes() {
    std::vector<std::string> files;
    for (const std::filesystem::path folder : {RAYMILL_SCENES, RAYMILL_SCENES "/lecture", RAYMILL_TERRAIN}) {
        if (!std::filesystem::is_directory(folder)) continue;
        const std::size_t first = files.size();
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".toml") files.push_back(entry.path().string());
        std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
    }
    return files;
}

/// Whether all pictures were alike.
bool run(const Arguments& a) {
    const Device device = open_device(a.device, a.threads);
    fmt::print("{} ({}), {} compute units; Embree {}. Seconds of a frame, medians of {} rounds in turn;\n",
               device.info.name, device.info.driver, device.info.compute_units, RTC_VERSION_STRING, a.rounds);
    fmt::print(
        "ratio: Embree's time over ours [quartiles]. Difference of the pictures: mean, and share of pixels.\n\n");
    fmt::print("{:<32} {:>8}  {:>10} {:>10}   {:<22} {}\n", "scene", "rays", "raymill", "embree", "ratio",
               "difference");
    std::vector<FrameResult> results;
    bool alike = true;
    for (const std::string& file : a.scenes.empty() ? project_scenes() : a.scenes) {
        results.push_back(measure_frame(a, device, file));
        print_result(results.back());
        alike &= results.back().difference.allowed();
    }
    print_summary(results);
    if (!a.json.empty()) write_json(a, device, results);
    return alike;
}

int fail(int status, const char* message) {
    fmt::print(stderr, "raymill_frames: {}\n", message);
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Renders whole frames beside a tracer of the same algorithm on Embree.", "raymill_frames");
    Arguments arguments;
    try {
        add_options(app, arguments);
        app.parse(argc, argv);
        // As the program does: workers that stay where they are. It must be set before OpenCL is loaded.
        setenv("POCL_AFFINITY", "1", 0);
        std::optional<tbb::global_control> limit;
        if (arguments.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, arguments.threads);
        return run(arguments) ? 0 : failed;
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return fail(bad_input, error.what());
    } catch (const SceneError& error) {
        return fail(bad_input, error.what());
    } catch (const std::exception& error) {
        return fail(failed, error.what());
    }
}
