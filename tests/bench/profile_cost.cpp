// raymill_profile_cost: what profiling a frame costs, with frames that are profiled and frames that are not in turns.
// Exit status: 0 measured; 1 something failed; 2 bad arguments or input.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "profile/statistics.hpp"
#include "profile/stopwatch.hpp"
#include "program.hpp"
#include "wavefront/renderer.hpp"

namespace {

using namespace raymill;
using profile::Clock;
using profile::Detail;
using profile::Quartiles;
using profile::quartiles;
using profile::seconds_of;

struct Arguments {
    std::vector<std::string> scenes;
    std::vector<std::uint64_t> capacities = {1024, 65536};
    int rounds = 21;
    int spp = 1;
    int width = 640, height = 360;
    unsigned threads = 0;
    Clock clock = Clock::wall;
};

const std::map<std::string, Clock> clocks = {{"wall", Clock::wall}, {"processor", Clock::processor}};

/// What is compared: the first is what the others are compared with, the second tells how far chance goes.
constexpr std::array variants = {std::pair{"off", Detail::none}, std::pair{"off again", Detail::none},
                                 std::pair{"--stats", Detail::totals}, std::pair{"--trace", Detail::launches}};

void add_options(CLI::App& app, Arguments& a) {
    app.add_option("scenes", a.scenes, "Scene files or models")->check(CLI::ExistingFile)->required();
    app.add_option("--queue-capacity", a.capacities, "Rays of a batch")->delimiter(',');
    app.add_option("--rounds", a.rounds, "Frames of each kind")->check(CLI::Range(1, 10000));
    app.add_option("--spp", a.spp, "Samples a pixel")->check(CLI::Range(1, 65536));
    app.add_option("--width", a.width)->check(CLI::Range(1, 65536));
    app.add_option("--height", a.height)->check(CLI::Range(1, 65536));
    app.add_option("--threads", a.threads, "0 for all")->check(CLI::Range(0u, 1024u));
    app.add_option("--clock", a.clock, "wall, or processor: time of all threads, for a busy machine")
        ->transform(CLI::CheckedTransformer(clocks));
}

/// A round renders a frame of each kind, the next one beginning with another kind; ratios are those within a round. On
/// a busy machine the fastest frames tell more.
void measure(const Arguments& a, const std::string& name, Renderer& renderer) {
    renderer.render();  // compiles the kernels, and touches the queues
    std::array<std::vector<double>, variants.size()> seconds, ratios;
    for (int round = 0; round < a.rounds; ++round) {
        for (std::size_t i = 0; i < variants.size(); ++i) {
            const std::size_t kind = (i + static_cast<std::size_t>(round)) % variants.size();
            seconds[kind].push_back(seconds_of([&] { renderer.render({}, variants[kind].second); }, a.clock));
        }
        for (std::size_t i = 0; i < variants.size(); ++i) ratios[i].push_back(seconds[i].back() / seconds[0].back());
    }
    const double fastest = std::ranges::min(seconds[0]);
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const Quartiles ratio = quartiles(ratios[i]);
        fmt::print("{:<18} {:>8} {:<10} {:>9.4f} s {:>+7.2f} %  [{:+.2f} {:+.2f}]   fastest {:.4f} s {:>+7.2f} %\n",
                   name, renderer.memory().queue_capacity, variants[i].first, quartiles(seconds[i]).median,
                   100 * (ratio.median - 1), 100 * (ratio.lower - 1), 100 * (ratio.upper - 1),
                   std::ranges::min(seconds[i]), 100 * (std::ranges::min(seconds[i]) / fastest - 1));
    }
    std::fflush(stdout);
}

void measure_scene(const Arguments& a, const Device& device, const std::string& file) {
    Scene scene = load_scene(file);
    scene.settings.spp = a.spp;
    scene.settings.width = a.width;
    scene.settings.height = a.height;
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, {a.threads});
    for (const std::uint64_t capacity : a.capacities) {
        RenderOptions options;
        options.memory.queue_capacity = capacity;
        options.memory.pipelines = 1;  // as what is profiled has
        Renderer renderer(device, scene, bvh, options);
        measure(a, std::filesystem::path(file).stem().string(), renderer);
    }
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app("Measures what profiling a frame costs.");
    add_options(app, arguments);
    return raymill::bench::run_program("raymill_profile_cost", app, argc, argv, [&] {
        const Device device = open_device("", arguments.threads);
        for (const std::string& file : arguments.scenes) measure_scene(arguments, device, file);
        return true;
    });
}
