// A sweep: one scene rendered with one setting after another, as plain data, and what is to be learned from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "profile/profile.hpp"

namespace raymill::profile {

/// A frame that was timed without being profiled.
struct TimedFrame {
    double seconds = 0;
    std::uint64_t film_hash = 0;
};

/// One setting and what was measured of it.
struct SweepSetting {
    std::uint64_t queue_capacity = 0;  // rays of a wave at most
    std::uint64_t work_group = 0;      // 0: what suits each stage
    unsigned threads = 0;              // compute units

    std::string skipped;                // why it was left out; empty if it was not
    std::uint64_t device_bytes = 0;     // the whole frame
    std::uint64_t wave_bytes = 0;       // what the stages of one wave go through, at most
    int pipelines = 1;                  // waves at once
    std::uint64_t rays = 0;             // of a frame: camera, secondary and shadow
    std::vector<TimedFrame> frames;     // in the order in which they ran
    std::optional<RunProfile> profile;  // of one frame more; there once a frame has been timed

    bool measured() const { return !frames.empty(); }
};

/// A cache of the processor.
struct Cache {
    std::string name;         // "L2"
    std::uint64_t bytes = 0;  // of one such cache
    unsigned sharers = 1;     // hardware threads that share it
};

struct Sweep {
    std::string version;  // of the program
    std::string scene;
    int width = 0, height = 0, depth = 0;
    int samples_per_pixel = 0;
    int scene_samples_per_pixel = 0;  // what the scene asks for
    bool samples_chosen = false;      // by the sweep, so that a frame takes about a second
    std::uint64_t primitives = 0;
    std::string device, platform, driver;
    std::uint64_t device_memory = 0;  // bytes
    std::vector<Cache> caches;
    int repeats = 0;       // timed frames of each setting
    bool complete = true;  // false: it was interrupted
    double seconds = 0;    // wall clock of the sweep
    std::vector<SweepSetting> settings;

    // A frame with every launch: one more of the best setting, or if the sweep was interrupted before, the profiled one
    // of the setting whose first frame was the fastest. None if nothing was measured.
    std::optional<RunProfile> timeline;
    std::size_t timeline_setting = 0;
};

/// The middle of the times and how far they lie apart.
struct Spread {
    double median = 0, shortest = 0, longest = 0;  // seconds
};

/// Of a setting's frames; zeros where there are none. The median of an even number is the mean of the middle two.
Spread spread(const SweepSetting& setting);

/// Rays (camera, secondary and shadow) per second of the median frame; 0 where none was measured.
double rays_per_second(const SweepSetting& setting);

/// A capacity belongs to the plateau if it loses no more than this share of the best rate, or is among
/// Finding::as_good: on a busy machine medians differ by more than this without meaning anything.
inline constexpr double knee_tolerance = 0.05;

struct Finding {
    std::optional<std::size_t> best;         // setting with the highest rate
    std::optional<std::size_t> knee;         // smallest capacity on the plateau, all else as in the best
    std::optional<std::size_t> below_knee;   // the next smaller one, if there is any
    double loss_below_knee = 0;              // share of the best rate that each smaller one loses at least
    std::vector<std::size_t> as_good;        // others whose fastest frame beats the best's median
    std::optional<std::uint64_t> film_hash;  // of the first frame
    std::vector<std::size_t> other_image;    // settings of which a frame has another hash

    bool same_image() const { return other_image.empty(); }
};

Finding find(const Sweep& sweep);

/// The finding in words: one or two sentences.
std::string headline(const Sweep& sweep, const Finding& finding);

/// The work-group as users write it: a number, or "auto".
std::string work_group_name(std::uint64_t work_group);

}  // namespace raymill::profile
