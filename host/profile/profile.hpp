// What a run did and how long each part of it took, as plain data: what tables, JSON, traces and reports are made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raymill::profile {

/// The kernels, in the order in which a frame first needs them.
enum class Stage : std::uint8_t { generate, intersect, shade, shadow, features, secondary, resolve };

inline constexpr std::size_t stage_count = 7;

/// Name of the kernel.
std::string_view stage_name(Stage stage);

/// How much is kept of a profiled frame. totals: memory does not grow with the frame. launches: every launch and wave
/// too.
enum class Detail { none, totals, launches };

/// Depth of a launch that belongs to no queue: resolve.
inline constexpr int no_depth = -1;
inline constexpr std::uint32_t no_wave = 0xffffffffu;

/// What became of rays. Each ray counts once, so the six add up to the rays; one_child + 2 * two_children is the number
/// of rays that they pushed.
struct Fates {
    std::uint64_t missed = 0;       // left the scene
    std::uint64_t absorbed = 0;     // hit a surface that passes nothing on
    std::uint64_t depth_limit = 0;  // hit a surface that does, where the recursion ends
    std::uint64_t weightless = 0;   // hit one that does, but no branch weighs at least min_weight and more than nothing
    std::uint64_t one_child = 0;    // reflected or refracted
    std::uint64_t two_children = 0;  // reflected and refracted

    std::uint64_t rays() const { return missed + hits(); }
    std::uint64_t hits() const { return absorbed + depth_limit + weightless + one_child + two_children; }
    std::uint64_t children() const { return one_child + 2 * two_children; }
    Fates& operator+=(const Fates& more);
    bool operator==(const Fates&) const = default;
};

/// Memory traffic and atomics of launches.
struct Traffic {
    // Each item of a queue (layout.h: Ray, Hit, ShadowRay, segment counts) counts whole, once for every launch that
    // reads or writes it. Exact in that sense; the scene, the film and what caches absorb are left out.
    std::uint64_t bytes_read = 0;
    std::uint64_t bytes_written = 0;
    // Operations that the kernels issued, on the film and on the counters that every frame needs, as they count them
    // themselves.
    std::uint64_t atomics = 0;

    Traffic& operator+=(const Traffic& more);
    bool operator==(const Traffic&) const = default;
};

/// What a launch moves.
struct QueueItems {
    Stage stage = Stage::generate;
    std::uint64_t in = 0, out = 0;  // see Launch
    std::uint64_t segments = 0;     // of shadow rays that shade writes, or shadow reads
    std::uint64_t hits = 0;         // among the rays of its wave
    std::uint64_t passing = 0;      // of these: on surfaces that pass light on
};

/// Bytes that follow from the sizes in layout.h; no atomics.
Traffic bytes_moved(const QueueItems& items);

/// One launch of a kernel. Times in nanoseconds of the host's steady clock, as the device's events tell.
struct Launch {
    Stage stage = Stage::generate;
    int depth = no_depth;          // of the rays it works on
    std::uint32_t wave = no_wave;  // from 0 on in the order in which they ran
    std::uint64_t items_in = 0;    // that its queue holds: rays, for shadow shadow rays; pixels' channels for resolve
    std::uint64_t items_out = 0;   // rays (generate, secondary), hits (intersect), shadow rays (shade), those not
                                   // blocked (shadow), channels (resolve); 0 for features, which makes no items
    std::uint64_t work_items = 0;  // that had work: one an item (resolve), chunk, segment (shadow) or, where rays are
                                   // traced together, FAMILY of hits (secondary)
    std::uint64_t groups = 0;      // work-groups
    std::uint64_t places = 0;      // items that these groups could have worked on
    Traffic traffic;
    std::int64_t queued = 0;     // the host asked
    std::int64_t submitted = 0;  // the runtime handed it to the device
    std::int64_t started = 0;
    std::int64_t ended = 0;
};

/// Rays of one queue that went through all stages together.
struct Wave {
    int depth = 0;
    std::uint64_t rays = 0;
    Fates fates;
    std::uint64_t shadow_rays = 0;     // pushed by shade
    std::uint64_t shadow_blocked = 0;  // of these: that brought nothing
};

/// The launches of one stage on rays of one depth.
struct StageTotal {
    Stage stage = Stage::generate;
    int depth = no_depth;
    std::uint64_t launches = 0;
    std::uint64_t items_in = 0;
    std::uint64_t items_out = 0;
    std::uint64_t work_items = 0;
    std::uint64_t groups = 0;
    std::uint64_t places = 0;
    std::uint64_t high_water = 0;  // largest items_out of a launch
    std::uint64_t capacity = 0;    // items that the queue it writes holds; 0 where it writes none
    Traffic traffic;
    double seconds = 0;                // from started to ended
    double shortest = 0, longest = 0;  // of a launch, in seconds

    /// Adds other launches of the same stage.
    StageTotal& operator+=(const StageTotal& more);
    /// Share of the places that held an item.
    double fullness() const { return places > 0 ? static_cast<double>(items_in) / static_cast<double>(places) : 0; }
};

/// A launch as the total of itself alone. capacity: of the queue that it writes.
StageTotal total_of(const Launch& launch, std::uint64_t capacity);

/// The queue of one depth and what became of its rays.
struct DepthTotal {
    int depth = 0;
    std::uint64_t capacity = 0;    // rays that the queue holds
    std::uint64_t high_water = 0;  // most rays that it ever held
    std::uint64_t pushed = 0;
    std::uint64_t popped = 0;  // as many as pushed, or the frame fails with QueueMismatch
    std::uint64_t waves = 0;
    Fates fates;
    std::uint64_t shadow_rays = 0;
    std::uint64_t shadow_blocked = 0;
};

/// Where the time of the frame went. Measured apart from each other; the four parts add up to `seconds` but for the
/// error with which the two clocks are compared.
struct FrameTimes {
    double seconds = 0;         // wall clock
    double kernels = 0;         // the device ran a kernel
    double first_launches = 0;  // it ran none, though one was queued that is the first of its stage in this frame:
                                // compiling it, or loading it from the runtime's cache
    double launching = 0;       // it ran none though one was queued: launch latency, clearing and reading counters
    double host = 0;            // it ran none and none was queued: host code, reading the picture

    double sum() const { return kernels + first_launches + launching + host; }
};

/// A profiled frame.
struct FrameProfile {
    Detail detail = Detail::none;
    std::vector<StageTotal> stages;  // by stage, then depth
    std::vector<DepthTotal> depths;  // from 0 on
    std::uint64_t shadow_capacity = 0;
    FrameTimes times;
    std::vector<Launch> launches;  // with Detail::launches, in the order in which they ran
    std::vector<Wave> waves;       // with Detail::launches

    /// The sum over depths.
    StageTotal total(Stage stage) const;
    Fates fates() const;
    std::uint64_t rays() const;  // camera and secondary
    std::uint64_t shadow_rays() const;
    std::uint64_t shadow_blocked() const;
};

/// A stretch of the host's time, in nanoseconds of its steady clock. Spans do not overlap.
struct Span {
    std::string name;
    std::int64_t start = 0;
    std::int64_t end = 0;
    double seconds() const { return 1e-9 * static_cast<double>(end - start); }
};

// Names of spans that have more to tell: see KernelCache and FrameTimes.
inline constexpr std::string_view kernels_span = "build kernels";
inline constexpr std::string_view render_span = "render";

/// Compiled kernels that a run loaded.
struct KernelCache {
    bool known = false;       // the runtime can be watched (PoCL on Linux)
    std::uint64_t built = 0;  // compiled by this run
    std::uint64_t from_cache = 0;
};

/// Everything about one run of the program.
struct RunProfile {
    // What was run.
    std::string scene;
    std::string device;
    unsigned compute_units = 0;
    int width = 0, height = 0, samples_per_pixel = 0;
    std::uint64_t queue_capacity = 0;  // rays of a wave at most
    std::uint64_t work_group = 0;      // 0: what suits each stage
    std::uint64_t primitives = 0;
    std::uint64_t device_bytes = 0;
    std::uint64_t film_hash = 0;

    std::vector<Span> spans;  // one after another: loading, building, rendering, writing ...
    KernelCache kernel_cache;
    FrameProfile frame;
    std::int64_t start = 0;  // of the run, nanoseconds of the host's steady clock
    double seconds = 0;      // wall clock of the run

    /// The part of `seconds` that no span covers.
    double unaccounted() const;
};

}  // namespace raymill::profile
