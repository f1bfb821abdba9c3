// Collects the counts and times of a frame while it is rendered.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "profile/profile.hpp"
#include "wavefront/stages.hpp"
#include "wavefront/waves.hpp"

namespace raymill {

/// The same moment on two clocks, in nanoseconds.
struct ClockReading {
    std::int64_t host = 0;    // profile::now()
    std::int64_t device = 0;  // of the queue's events
};

/// Reads both clocks; waits until the device is idle.
ClockReading read_clocks(const Device& device);

/// Between waves the profiler holds totals; with Detail::launches every launch and wave too. Calls go in the order
/// launched ... settle ... end_wave, and again for the next wave.
class Profiler {
  public:
    struct FrameShape {
        uint queue_capacity = 0;
        std::uint64_t shadow_capacity = 0;  // rays of one pass
        std::size_t passes = 1;             // over the light samples
        int max_depth = 0;
    };

    /// The frame begins. The device must outlive the profiler.
    Profiler(const Device& device, const FrameShape& shape, profile::Detail detail);

    void launched(const LaunchSize& size, const cl::Event& event) { wave_.launches.push_back({size, event}); }

    /// Works out what the last wave did: to be called when this one's kernels are on their way, so that the device need
    /// not wait for it.
    void settle();

    /// Everything launched so far has finished, and `counters` is what it left, one a pass over the light samples.
    /// Throws QueueMismatch where the kernels' counts contradict each other.
    void end_wave(const Batch& batch, std::span<const Counters> counters);

    /// The frame's last launch has finished.
    profile::FrameProfile finish(const Waves& waves);

  private:
    struct TimedLaunch {
        LaunchSize size;
        cl::Event event;
    };
    /// The launches of a wave, and what they left in the counters.
    struct PendingWave {
        std::vector<TimedLaunch> launches;
        std::vector<Counters> before, after;  // of each pass
        int depth = profile::no_depth;
        std::uint32_t number = profile::no_wave;
        profile::Fates fates;
        std::uint64_t passing = 0;  // hits on surfaces that pass light on
    };
    void settle(PendingWave& wave);
    // Of launches whose times are those of the device's clock.
    void count(const profile::Launch& launch);
    void count_gap(const profile::Launch& launch, bool first_launch);
    void count_wave(const profile::Wave& wave);
    std::uint64_t capacity_after(const profile::Launch& launch) const;
    profile::StageTotal& place_of(profile::Stage stage, int depth);

    const Device& device_;
    FrameShape shape_;
    profile::FrameProfile frame_;
    PendingWave wave_;   // that is being launched
    PendingWave ended_;  // that has run, but was not settled yet
    std::uint32_t waves_ = 0;
    std::array<bool, profile::stage_count> launched_{};  // stages that have been, in this frame
    std::int64_t start_;                                 // of the frame, host
    ClockReading clocks_;
    std::int64_t last_end_ = 0;  // of the last kernel, device; 0: none yet
};

}  // namespace raymill
