// Flags that several commands share, and what they do to a scene.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

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
    Traversal traversal = Traversal::automatic;
    BvhQuality bvh = BvhQuality::high;
    std::string kernel_dir;

    void add_to(CLI::App& command);
    /// All but --mem-limit, for what allocates no more than it needs.
    void add_without_memory_to(CLI::App& command);
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

}  // namespace raymill
