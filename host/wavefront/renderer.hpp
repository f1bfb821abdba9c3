// The wavefront loop: camera samples in, integer film out.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "profile/timeline.hpp"
#include "wavefront/pipeline.hpp"
#include "wavefront/profiler.hpp"

namespace raymill {

struct RenderOptions {
    MemoryRequest memory;
    FilmPlanes planes;           // what the film keeps beside the beauty
    bool keep_sums = true;       // fills Frame::sums, for layers and for the hash
    std::size_t work_group = 0;  // items; 0: what suits each stage
    Traversal traversal = Traversal::automatic;
    std::string kernel_dir;  // empty: the embedded kernels
    // Stages of compiled_stages whose kernels are to be compiled before the first frame; empty: all.
    std::vector<profile::Stage> compile;
    // A command that compiles the kernels of compile_helper_stages into the runtime's cache; empty: none.
    std::vector<std::string> compile_helper;
};

/// Those whose kernels take long to compile; the others' are compiled when a frame first launches them.
inline constexpr std::array compiled_stages = {profile::Stage::generate, profile::Stage::intersect,
                                               profile::Stage::shade, profile::Stage::shadow,
                                               profile::Stage::secondary};

/// What is left to the helper: about half of the work, and not what is compiled first.
inline constexpr std::array compile_helper_stages = {profile::Stage::shadow, profile::Stage::shade};

struct RayCounts {
    std::uint64_t camera = 0;
    std::uint64_t secondary = 0;
    std::uint64_t shadow = 0;
    std::uint64_t total() const { return camera + secondary + shadow; }
};

struct Frame {
    std::vector<float> rgba;  // of the crop window, row by row from the top
    int samples_per_pixel = 1;
    FilmPlanes planes;
    std::vector<cl_long> sums;  // the film's integers: planes, in them pixels, in them FILM_CHANNELS
    RayCounts rays;
    std::uint64_t shadow_blocked = 0;
    std::uint64_t saturated = 0;     // film contributions that were cut
    std::uint64_t not_a_number = 0;  // film contributions that were left out
    std::uint64_t waves = 0;
    double seconds = 0;             // from the first sample to the picture
    double finished = 1;            // share of the camera samples; less than 1 when interrupted
    profile::FrameProfile profile;  // when asked for

    /// The integers of a plane that is kept.
    std::span<const cl_long> plane(int plane) const;
    /// Of the film's integers: like FNV-1a, but a word of 64 bits a step, and the channels apart.
    std::uint64_t hash() const;
};

/// What the queues hold right after a stage of a wave. Valid during the call only.
struct WaveView {
    Batch batch;
    QueueRange<Ray> rays;
    const Buffer<Hit>& hits;
    SlotRange slots;                          // light samples of this pass, for shade and shadow
    const ShadowQueue& shadow_rays;           // as shade left it: segment = chunk * slots.count + slot
    std::optional<QueueRange<Ray>> children;  // after secondary
    const Film& film;
    std::uint64_t first_sample;  // camera sample of the first ray, after generate
};

/// Called after each of "generate", "intersect", "shade", "shadow" and "secondary" has run, when the device is idle: one
/// pipeline is used then.
using WaveObserver = std::function<void(const char* stage, const WaveView& view)>;

/// Called when a wave has been launched, before it has run, with the share of camera samples that have been generated;
/// returns false to stop: these are finished, no more are generated.
using Progress = std::function<bool(double share)>;

class Renderer {
  public:
    /// Builds the kernels and uploads the scene. The references must outlive the renderer. Throws DeviceError.
    Renderer(const Device& device, const Scene& scene, const Bvh& bvh, const RenderOptions& options);

    const MemoryPlan& memory() const { return plan_; }

    /// Shows every queue of the following frames to `observer`: slow, for explaining and verifying.
    void observe(WaveObserver observer) { observer_ = std::move(observer); }
    const DeviceScene& device_scene() const { return device_scene_; }
    Stages& stages() { return stages_; }

    /// Frame::hash() of the last frame, without a copy of its integers.
    std::uint64_t hash_film() const;

    /// What the constructor did: building the kernels, uploading the scene, allocating the queues, compiling.
    const std::vector<profile::Span>& setup() const { return timeline_.spans(); }

    /// Renders one frame. detail: what Frame::profile tells. Throws DeviceError, QueueOverflow, QueueMismatch.
    Frame render(const Progress& progress = {}, profile::Detail detail = profile::Detail::none);

  private:
    void allocate();
    void compile_kernels(const RenderOptions& options);
    void compile(profile::Stage stage);
    void make_ready();
    void start(profile::Detail detail);
    void trace_all(const Progress& progress);
    bool begin_wave(Pipeline& pipeline, std::uint64_t to_come);
    void finish_wave(Pipeline& pipeline);
    void trace(Pipeline& pipeline, const Batch& batch);
    Frame read_frame();
    std::vector<float> resolve();
    void show(const char* stage, const Pipeline& pipeline, const Batch& batch, SlotRange slots = {},
              std::optional<QueueRange<Ray>> children = {}) const;

    const Device& device_;
    const Scene& scene_;
    FilmPlanes planes_;
    bool keep_sums_;
    MemoryPlan plan_;
    profile::Timeline timeline_;
    Stages stages_;
    DeviceScene device_scene_;
    int max_depth_;
    std::vector<SlotRange> slot_ranges_;
    Buffer<cl_long> sums_;  // of the film
    std::vector<Pipeline> pipelines_;
    std::vector<float> rgba_;  // the picture to come
    bool ready_ = false;       // the film and rgba_ are cleared
    RayCounts counts_;
    WaveObserver observer_;
    std::optional<Profiler> profiler_;
};

}  // namespace raymill
