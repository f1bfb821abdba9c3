// raymill_kernels: frames of one scene by the kernels of several folders, in turns, so that what else the machine does
// falls on all of them alike.
// Exit status: 0 measured; 1 pictures differ, or something failed; 2 bad arguments or input.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "profile/statistics.hpp"
#include "program.hpp"
#include "wavefront/renderer.hpp"

namespace {

using namespace raymill;
using profile::Detail;
using profile::Quartiles;
using profile::quartiles;
using profile::Stage;

struct Arguments {
    std::string scene;
    std::vector<std::string> folders;
    int rounds = 21;
    int spp = 0;
    unsigned threads = 0;
};

/// Seconds of each frame by one folder's kernels: those of each stage and of the whole frame.
struct Times {
    std::array<std::vector<double>, profile::stage_count> stages;
    std::vector<double> frames;
};

void add_options(CLI::App& app, Arguments& a) {
    app.add_option("scene", a.scene, "Scene file or model")->check(CLI::ExistingFile)->required();
    app.add_option("folders", a.folders,
                   "Folders of kernels, as for --kernel-dir; the first is what others are compared with, and twice the "
                   "same shows how far chance goes")
        ->check(CLI::ExistingDirectory)
        ->required();
    app.add_option("--rounds", a.rounds, "Frames by each folder")->check(CLI::Range(1, 100000));
    app.add_option("--spp", a.spp, "Samples a pixel instead of the scene's")->check(CLI::Range(1, 65536));
    app.add_option("--threads", a.threads, "0 for all")->check(CLI::Range(0u, 1024u));
}

void render_once(Renderer& renderer, Times& times) {
    const Frame frame = renderer.render({}, Detail::totals);
    times.frames.push_back(frame.profile.times.seconds);
    for (std::size_t stage = 0; stage < profile::stage_count; ++stage)
        times.stages[stage].push_back(frame.profile.total(static_cast<Stage>(stage)).seconds);
}

/// Ratios are those within a round.
void print_row(std::string_view name, const std::vector<double>& base, const std::vector<double>& seconds) {
    if (quartiles(base).median <= 0) return;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < base.size(); ++i) ratios.push_back(seconds[i] / base[i]);
    const Quartiles ratio = quartiles(ratios);
    fmt::print("  {:<10} {:>10.3f} ms {:>+7.1f} %  [{:+.1f} {:+.1f}]   fastest {:.3f} ms {:>+7.1f} %\n", name,
               1e3 * quartiles(seconds).median, 100 * (ratio.median - 1), 100 * (ratio.lower - 1),
               100 * (ratio.upper - 1), 1e3 * std::ranges::min(seconds),
               100 * (std::ranges::min(seconds) / std::ranges::min(base) - 1));
}

void print(const std::string& folder, const Times& base, const Times& times) {
    fmt::print("{}\n", folder);
    for (std::size_t stage = 0; stage < profile::stage_count; ++stage)
        print_row(profile::stage_name(static_cast<Stage>(stage)), base.stages[stage], times.stages[stage]);
    print_row("frame", base.frames, times.frames);
}

/// Whether all folders' kernels render the same picture.
bool measure(const Arguments& a) {
    const Device device = open_device("", a.threads);
    Scene scene = load_scene(a.scene);
    if (a.spp > 0) scene.settings.spp = a.spp;
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, {a.threads});
    std::deque<Renderer> renderers;
    for (const std::string& folder : a.folders) {
        RenderOptions options;
        options.keep_sums = false;
        options.kernel_dir = folder;
        renderers.emplace_back(device, scene, bvh, options).render();  // compiles the kernels, too
    }
    std::vector<Times> times(renderers.size());
    for (std::size_t round = 0; round < static_cast<std::size_t>(a.rounds); ++round)
        for (std::size_t i = 0; i < renderers.size(); ++i) {
            const std::size_t turn = (i + round) % renderers.size();  // none always follows the same
            render_once(renderers[turn], times[turn]);
        }
    bool same = true;
    for (std::size_t i = 0; i < times.size(); ++i) {
        print(a.folders[i], times[0], times[i]);
        if (renderers[i].hash_film() == renderers[0].hash_film()) continue;
        fmt::print("  ANOTHER PICTURE\n");
        same = false;
    }
    return same;
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app("Measures the kernels of several folders beside each other, frame by frame in turns.");
    add_options(app, arguments);
    return raymill::bench::run_program("raymill_kernels", app, argc, argv, [&] { return measure(arguments); });
}
