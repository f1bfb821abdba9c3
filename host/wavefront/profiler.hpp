// Collects the counts and times of a frame while it is rendered.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "profile/profile.hpp"
#include "wavefront/film_planes.hpp"
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
/// launched ... end_pass ... end_wave, and again for the next wave.
class Profiler {
  public:
    struct FrameShape {
        uint queue_capacity = 0;
        std::uint64_t shadow_capacity = 0;  // rays of one pass
        std::size_t passes = 1;             // over the light samples
        int max_depth = 0;
        FilmPlanes planes;
    };

    /// The frame begins. The device must outlive the profiler.
    Profiler(const Device& device, const FrameShape& shape, profile::Detail detail);

    void launched(const LaunchSize& size, const cl::Event& event) { pending_.push_back({size, event}); }

    /// shade and shadow have been launched for a range of light samples: asks for the counters, without waiting.
    void end_pass(const Buffer<Counters>& counters);

    /// Everything launched so far has finished, and `counters` is what it left. Throws QueueMismatch where the kernels'
    /// counts contradict each other.
    void end_wave(const Batch& batch, const Counters& counters);

    /// The frame's last launch has finished.
    profile::FrameProfile finish(const Waves& waves);

  private:
    struct Pending {
        LaunchSize size;
        cl::Event event;
    };
    struct Times {
        std::int64_t queued, submitted, started, ended;  // of the device's clock
    };
    void settle(const Counters& counters, profile::Launch launch, std::uint64_t hits, std::uint64_t children);
    void count(const profile::Launch& launch, const Times& times);
    void count_gap(const Times& times, bool first_launch);
    void count_wave(const profile::Wave& wave);
    std::uint64_t capacity_after(const profile::Launch& launch) const;
    profile::StageTotal& total_of(profile::Stage stage, int depth);

    const Device& device_;
    FrameShape shape_;
    profile::FrameProfile frame_;
    std::vector<Pending> pending_;
    std::vector<Counters> passes_;  // the counters after each pass of this wave but the last
    std::size_t pass_ = 0;
    Counters before_{};  // the counters when this wave began
    std::uint32_t waves_ = 0;
    std::int64_t start_;  // of the frame, host
    ClockReading clocks_;
    std::int64_t last_end_ = 0;  // of the last kernel, device; 0: none yet
};

}  // namespace raymill
