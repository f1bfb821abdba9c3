// Flags that several commands share, and what they do to a scene.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bvh/bvh.hpp"
#include "device/device.hpp"
#include "scene/scene.hpp"
#include "wavefront/renderer.hpp"

namespace raymill {

/// The scene and what the command line overrides of its [render] table.
struct SceneArguments {
    std::string file;
    std::string size;
    std::optional<int> spp;
    std::optional<int> depth;
    std::string integrator;
    std::string crop;
    std::optional<std::uint32_t> seed;
    std::optional<double> exposure;

    /// Returns the option of the file, which is required.
    CLI::Option* add_to(CLI::App& command);
    /// Whether anything but the file is given.
    bool has_overrides() const;
    /// Loads the scene and applies the overrides. Throws SceneError, UsageError.
    Scene load() const;
};

/// Which device renders, and in how much memory.
struct DeviceArguments {
    std::string device;
    unsigned threads = 0;
    std::uint32_t queue_capacity = 0;
    std::uint32_t work_group = 0;
    std::string mem_limit;
    int pipelines = MemoryRequest{}.pipelines;
    Traversal traversal = Traversal::automatic;
    BvhQuality bvh = BvhQuality::high;
    std::string kernel_dir;

    void add_to(CLI::App& command);
    /// All but --mem-limit, for what allocates no more than it needs.
    void add_without_memory_to(CLI::App& command);
    /// All but the threads, the queue capacity and the work-group.
    void add_fixed_to(CLI::App& command);
    void add_memory_to(CLI::App& command);
    /// --pipelines, for commands that render frames of which nobody watches each wave.
    void add_pipelines_to(CLI::App& command);
    /// Device, kernels, traversal and hierarchy.
    void add_what_never_varies_to(CLI::App& command);
    Device open() const { return open_device(device, threads); }
    BvhOptions bvh_options() const { return {threads, bvh}; }
    /// Throws UsageError.
    RenderOptions options() const;
};

/// "640x480" to width and height. Throws UsageError.
std::pair<int, int> parse_size(const std::string& text);

/// "0.25,0.75,0,1" in pbrt's order x0, x1, y0, y1. Throws UsageError.
Crop parse_crop(const std::string& text);

/// "512M", "2GiB", "1000000" to bytes: K, M, G and T are powers of 1024. Throws UsageError.
std::uint64_t parse_bytes(const std::string& text);

/// Throws UsageError if writing `output`, which may be missing or empty, would replace `input`.
void check_keeps(const std::string& input, const std::string& output);

/// What --queue-capacity, --work-group and --threads are given: numbers from 1 to `largest`, where k is 1024 and M 1024
/// squared, or `word`, if that is not empty, which stands for 0.
struct CountFlag {
    std::string name;  // as in errors
    std::uint32_t largest;
    std::string word{};

    /// The option of a command that takes one number, which `value` receives. Parsing throws UsageError.
    void add_to(CLI::App& command, std::uint32_t& value, const std::string& description) const;
    /// "64k" to a number. Throws UsageError.
    std::uint32_t parse(const std::string& text) const;
    /// "1k,64k,1M" to numbers, sorted, each once. Throws UsageError.
    std::vector<std::uint32_t> parse_list(const std::string& list) const;
};

inline const CountFlag queue_capacity_flag{"--queue-capacity", 1u << 28};
inline const CountFlag work_group_flag{"--work-group", 1u << 20, "auto"};
inline const CountFlag threads_flag{"--threads", 65536, "all"};

}  // namespace raymill
