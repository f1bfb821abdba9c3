// raymill replay: one captured launch of a stage, alone, as often as one likes: a kernel engineer's bench.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "bvh/bvh.hpp"
#include "capture/replay.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "common/files.hpp"
#include "profile/statistics.hpp"
#include "profile/stopwatch.hpp"
#include "wavefront/records.hpp"

namespace raymill {

namespace {

constexpr int other_output = 1;
constexpr int format_version = 1;

struct ReplayArguments {
    std::string file;
    std::string scene;
    DeviceArguments device;
    int repeats = 11;
    profile::Clock clock = profile::Clock::wall;
    std::string json_file;
};

struct Measurement {
    capture::Outcome outcome;     // of the first run, which is not timed: it may compile the kernel
    std::uint64_t other = 0;      // repeats that wrote something else
    std::vector<double> seconds;  // of each repeat
    std::uint64_t launches = 0;   // of a repeat
    profile::Traffic traffic;

    double best() const { return *std::ranges::min_element(seconds); }
    double worst() const { return *std::ranges::max_element(seconds); }
};

Measurement measure(const ReplayArguments& arguments, capture::Replay& replay) {
    Measurement m;
    m.launches = replay.launches();
    replay.clear();
    replay.run();
    m.outcome = replay.read();
    for (int repeat = 0; repeat < arguments.repeats; ++repeat) {
        replay.clear();
        m.seconds.push_back(profile::seconds_of([&] { replay.run(); }, arguments.clock));
        m.other += replay.read().digest != m.outcome.digest;
    }
    m.traffic = replay.traffic(m.outcome);
    return m;
}

double per_item(double value, const capture::Capture& capture) {
    return value / static_cast<double>(std::max<std::uint64_t>(capture.items(), 1));
}

const char* clock_name(profile::Clock clock) {
    return clock == profile::Clock::wall ? "wall" : "processor";
}

std::string digest_text(const capture::Digest& digest) {
    return fmt::format("queue {:016x}, film {:016x}", digest.queue, digest.film);
}

std::string verdict(const capture::Capture& capture, const Measurement& m) {
    if (m.other > 0) return fmt::format("NOT the same in {} of {} repeats", m.other, m.seconds.size());
    if (m.outcome.digest == capture.digest) return "the same in every repeat, and as captured";
    return fmt::format("the same in every repeat, but NOT as captured ({})", digest_text(capture.digest));
}

void print_report(const ReplayArguments& arguments, const capture::Capture& capture, const std::string& scene_file,
                  const Device& device, const Measurement& m) {
    const capture::FrameKey& frame = capture.frame;
    const profile::Quartiles time = profile::quartiles(m.seconds);
    std::string slots;
    if (capture.slots.count > 0)
        slots =
            fmt::format(", light samples {} to {}", capture.slots.first, capture.slots.first + capture.slots.count - 1);
    fmt::print("stage    {} at depth {}, launch {}{}\n", profile::stage_name(capture.stage), capture.depth,
               capture.launch, slots);
    fmt::print("scene    {}, {} x {} pixels, {} spp, depth {}\n", scene_file, frame.width, frame.height, frame.spp,
               frame.depth);
    fmt::print("device   {}, {} compute units{}\n", device.info.name, device.info.compute_units,
               arguments.device.kernel_dir.empty() ? "" : ", kernels from " + arguments.device.kernel_dir);
    fmt::print("items    {} in, {} out\n", capture.items(), m.outcome.items_out);
    fmt::print("bytes    {:.1f} read and {:.1f} written an item, {:.2f} atomics\n",
               per_item(static_cast<double>(m.traffic.bytes_read), capture),
               per_item(static_cast<double>(m.traffic.bytes_written), capture),
               per_item(static_cast<double>(m.traffic.atomics), capture));
    fmt::print("repeats  {}, of {} launch{} each, {} clock\n", m.seconds.size(), m.launches,
               m.launches == 1 ? "" : "es", clock_name(arguments.clock));
    fmt::print("time     {:.4f} ms; half of the repeats {:.4f} to {:.4f}, all {:.4f} to {:.4f}\n", 1e3 * time.median,
               1e3 * time.lower, 1e3 * time.upper, 1e3 * m.best(), 1e3 * m.worst());
    fmt::print("rate     {:.2f} million items/s, {:.2f} ns an item\n",
               1e-6 * static_cast<double>(capture.items()) / time.median, per_item(1e9 * time.median, capture));
    fmt::print("output   {}: {}\n", digest_text(m.outcome.digest), verdict(capture, m));
}

nlohmann::ordered_json digest_json(const capture::Digest& digest) {
    return {{"queue", fmt::format("{:016x}", digest.queue)}, {"film", fmt::format("{:016x}", digest.film)}};
}

nlohmann::ordered_json to_json(const ReplayArguments& arguments, const capture::Capture& capture,
                               const std::string& scene_file, const Device& device, const Measurement& m) {
    const capture::FrameKey& frame = capture.frame;
    const profile::Quartiles time = profile::quartiles(m.seconds);
    return {{"format", format_version},
            {"stage", profile::stage_name(capture.stage)},
            {"depth", capture.depth},
            {"launch", capture.launch},
            {"first_light_sample", capture.slots.first},
            {"light_samples", capture.slots.count},
            {"scene", scene_file},
            {"scene_hash", fmt::format("{:016x}", frame.scene_hash)},
            {"width", frame.width},
            {"height", frame.height},
            {"samples_per_pixel", frame.spp},
            {"device", device.info.name},
            {"compute_units", device.info.compute_units},
            {"work_group", arguments.device.work_group},
            {"kernel_dir", arguments.device.kernel_dir},
            {"items_in", capture.items()},
            {"items_out", m.outcome.items_out},
            {"bytes_read", m.traffic.bytes_read},
            {"bytes_written", m.traffic.bytes_written},
            {"atomics", m.traffic.atomics},
            {"launches", m.launches},
            {"clock", clock_name(arguments.clock)},
            {"seconds", m.seconds},
            {"median", time.median},
            {"lower_quartile", time.lower},
            {"upper_quartile", time.upper},
            {"output", digest_json(m.outcome.digest)},
            {"captured_output", digest_json(capture.digest)},
            {"repeats_with_other_output", m.other}};
}

int replay(const ReplayArguments& arguments) try {
    const RenderOptions options = arguments.device.options();
    const auto [capture, scene] = capture::load_capture(arguments.file, arguments.scene, "--scene");
    if (!arguments.json_file.empty()) {
        check_keeps(arguments.file, arguments.json_file);
        check_keeps(scene.file, arguments.json_file);
        check_writable(arguments.json_file);
    }
    print_warnings(scene.warnings);
    const Device device = arguments.device.open();
    const Bvh bvh = build_bvh(scene.vertices, scene.triangles, scene.spheres, arguments.device.bvh_options());
    Stages stages(device, options.work_group, options.kernel_dir, options.traversal);
    const DeviceScene on_device(device, scene, bvh, capture.frame.planes);
    capture::Replay replay(device, stages, on_device, capture, film_pixels(scene), options.memory.queue_capacity);
    const Measurement m = measure(arguments, replay);
    print_report(arguments, capture, scene.file, device, m);
    if (!arguments.json_file.empty())
        write_text_atomically(arguments.json_file, [&](std::ostream& out) {
            out << to_json(arguments, capture, scene.file, device, m)
                       .dump(1, ' ', false, nlohmann::json::error_handler_t::replace)
                << '\n';
        });
    return m.other == 0 && m.outcome.digest == capture.digest ? 0 : other_output;
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

}  // namespace

Command add_replay_command(CLI::App& app) {
    auto arguments = std::make_shared<ReplayArguments>();
    CLI::App& command = *app.add_subcommand(
        "replay",
        "Run one captured launch of a stage again and again, and tell its time and whether a bit has changed");
    command.add_option("FILE", arguments->file, "What render --capture wrote")->required();
    command.add_option("--scene", arguments->scene, "Where the scene is now, if it has moved")->type_name("SCENE");
    command.add_option("--repeats", arguments->repeats, "Timed runs, after one that is not timed")
        ->type_name("N")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    static const std::map<std::string, profile::Clock> clocks = {{"wall", profile::Clock::wall},
                                                                 {"processor", profile::Clock::processor}};
    command
        .add_option(
            "--clock", arguments->clock,
            "wall (default), or processor: the time of all threads, steadier on a busy machine with --threads 1")
        ->type_name("NAME")
        ->transform(CLI::CheckedTransformer(clocks).description(""));
    command.add_option("--json", arguments->json_file, "The same for programs, with the time of each repeat")
        ->type_name("FILE");
    arguments->device.add_without_memory_to(command);
    command.footer(
        "The queue goes through in one launch, or with --queue-capacity in several of at most so many rays. The\n"
        "output is a hash of the items that the stage pushed and one of the film; neither depends on threads,\n"
        "capacity, work-group or traversal, so another one means another result.\n\n"
        "Examples:\n"
        "  raymill render scenes/first-light.toml --capture 1,intersect,queue.wave\n"
        "  raymill replay queue.wave --threads 1 --clock processor\n"
        "  raymill replay queue.wave --kernel-dir my-kernels --repeats 101 --json mine.json\n\n"
        "Exit status: 0 the output is as captured; 1 it is not, or the device failed; 2 bad arguments or input.");
    return [arguments] { return replay(*arguments); };
}

}  // namespace raymill
