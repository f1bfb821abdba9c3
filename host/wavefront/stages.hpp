// The stages: one typed method a kernel, named like it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "profile/profile.hpp"
#include "wavefront/device_scene.hpp"

namespace raymill {

/// `count` items of a queue from `first` on.
template <class T>
struct QueueRange {
    const Buffer<T>& items;
    uint first = 0;
    uint count = 0;
};

/// Where items are added to a queue: from `first` on.
template <class T>
struct QueueEnd {
    Buffer<T>& items;
    uint first = 0;
};

/// Segments of CHUNK shadow rays: one a chunk of hits and light sample.
struct ShadowQueue {
    Buffer<ShadowRay> rays;
    Buffer<uint> counts;
};

/// Integer sums of every plane and pixel of the rendered window, and what went wrong while adding.
struct Film {
    Buffer<cl_long> sums;
    Buffer<Counters> counters;
    /// No two items of the launches to come have the same pixel, nor has any other launch that runs meanwhile, so that
    /// they need not add atomically.
    bool pixels_once = false;
    /// The kernels count for a profile, too: see Counters.
    bool counted = false;
    /// Which of the counters shade and shadow add to; other stages add to the first.
    uint pass = 0;
};

/// Film::pixels_once of launches on rays of this depth: camera rays of one sample a pixel have each its own, and what
/// descends from them stays in their pipeline. slots: light samples of the pass, for shadow, since a hit has a shadow ray
/// for each.
inline bool pixels_once(int depth, int spp, uint slots = 1) {
    return depth == 0 && spp == 1 && slots == 1;
}

/// Atomic operations that this kernel has counted; none for kernels that issue none.
std::uint64_t atomics_of(const Counters& counters, profile::Stage stage);

/// Light samples [first, first + count) of the scene's list.
struct SlotRange {
    uint first = 0;
    uint count = 0;
};

/// What a launch was asked to do; see profile::Launch.
struct LaunchSize {
    profile::Stage stage;
    std::uint64_t items;
    std::uint64_t work_items;
    std::uint64_t groups;
    std::uint64_t places;
    std::uint64_t segments;  // of shadow rays: that shade writes, or shadow reads
};

/// Called after each launch with its event, where launches are to be timed. items of shadow are the places of its
/// segments: only the device knows how many rays are in them.
using LaunchObserver = std::function<void(const LaunchSize& size, const cl::Event& event)>;

/// How rays go through the hierarchy. packet: coherent rays of a chunk together, as vector units like it; single: each
/// alone. automatic: packet on processors, single elsewhere. The picture does not depend on it.
enum class Traversal { automatic, packet, single };

class Stages {
  public:
    /// work_group: items of a work-group, 0 for what suits each stage. kernel_dir: see kernel_source().
    Stages(const Device& device, std::size_t work_group, const std::string& kernel_dir,
           Traversal traversal = Traversal::automatic);

    void observe(LaunchObserver observer) { observer_ = std::move(observer); }

    /// Launches go to this queue of the device from now on; at first, to the device's own.
    void launch_on(const cl::CommandQueue& queue) { queue_ = queue; }

    /// While on, a launch of no items runs one work-item, which finds nothing to do: runtimes compile a kernel when it
    /// is launched for the first time.
    void run_empty_launches(bool on) { runs_empty_launches_ = on; }

    void generate(const DeviceScene& scene, std::uint64_t first_sample, uint count, Buffer<Ray>& rays);
    void intersect(const DeviceScene& scene, QueueRange<Ray> rays, Buffer<Hit>& hits, Film& film);
    void shade(const DeviceScene& scene, QueueRange<Ray> rays, const Buffer<Hit>& hits, SlotRange slots,
               ShadowQueue& shadow_rays, Film& film);
    /// Adds to the planes of features that the scene's constants say are kept. All rays are of depth `depth`.
    void features(const DeviceScene& scene, QueueRange<Ray> rays, uint depth, const Buffer<Hit>& hits, Film& film);
    void shadow(const DeviceScene& scene, const ShadowQueue& shadow_rays, uint segments, Film& film);
    /// Counts its children in film.counters.children, from the value it finds there.
    void secondary(const DeviceScene& scene, QueueRange<Ray> rays, const Buffer<Hit>& hits, QueueEnd<Ray> children,
                   Film& film);
    void resolve(const Film& film, uint spp, Buffer<float>& pixels);

    static uint chunks(uint items) { return (items + CHUNK - 1) / CHUNK; }

  private:
    struct Stage {
        profile::Stage name;
        cl::Kernel kernel;
        std::size_t local_size;
        uint items;  // of a work-item

        uint work_items(uint queue_items) const { return (queue_items + items - 1) / items; }
    };
    /// What a launch is to work on: see LaunchSize.
    struct Work {
        uint work_items = 0;
        uint items = 0;
        uint segments = 0;
    };
    cl::Program build(const std::vector<std::string>& files) const;
    Stage chunk_stage(const cl::Program& program, profile::Stage name) const;
    void build_features();
    template <class... Arguments>
    void launch(Stage& stage, const Work& work, const Arguments&... arguments);

    const Device& device_;
    std::size_t work_group_;
    std::string kernel_dir_;
    bool packets_;
    cl::CommandQueue queue_;
    LaunchObserver observer_;
    bool runs_empty_launches_ = false;
    Stage generate_, intersect_, shade_, shadow_, secondary_, resolve_;
    std::optional<Stage> features_;  // most frames do not need it: built when first launched
};

}  // namespace raymill
