// Runs a captured launch again, alone and any number of times.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "capture/capture.hpp"
#include "wavefront/renderer.hpp"

namespace raymill::capture {

/// What a run wrote.
struct Outcome {
    Digest digest;
    std::uint64_t items_out = 0;  // rays (generate, secondary), hits (intersect), shadow rays (shade), those that were
                                  // not blocked (shadow)
};

class Replay {
  public:
    /// scene must keep the planes that the capture's frame kept. film_pixels: of its window. capacity: rays of a launch
    /// at most, in whole chunks for shadow; 0: one launch for all. What is written does not depend on it. The
    /// references must outlive the replay, the capture need not. Throws DeviceError.
    Replay(const Device& device, Stages& stages, const DeviceScene& scene, const Capture& capture,
           std::uint64_t film_pixels, std::uint64_t capacity = 0);

    /// Forgets what the last run wrote.
    void clear();
    /// Launches the stage and waits for it. Throws DeviceError.
    void run();
    /// What was written since clear(). Throws QueueOverflow if more was pushed than the queue holds.
    Outcome read() const;

    std::uint64_t launches() const { return pieces_.size(); }

    /// Memory traffic and atomics as --stats-json has them; runs the stage once more, and clears what was written.
    profile::Traffic traffic(const Outcome& outcome);

    /// The queues as an observer of the frame saw them after the stage, where one launch does for all.
    WaveView view() const;

  private:
    /// What one launch works on.
    struct Piece {
        std::uint64_t first_sample = 0;
        uint count = 0;     // rays
        uint segments = 0;  // of shadow rays
        Buffer<Ray> rays;
        Buffer<Hit> hits;
        ShadowQueue shadow_rays;
    };
    /// Of rays [first, first + count). places: the capture's shadow rays in their segments.
    Piece make_piece(const Capture& capture, std::span<const ShadowRay> places, uint first, uint count) const;
    void launch(Piece& piece);
    std::uint64_t queue_digest(const Counters& counters, std::uint64_t& items_out) const;

    const Device& device_;
    Stages& stages_;
    const DeviceScene& scene_;
    profile::Stage stage_;
    int depth_;
    SlotRange slots_;
    std::uint64_t items_;
    std::vector<Piece> pieces_;
    Buffer<Ray> children_;  // of all pieces
    Film film_;
};

}  // namespace raymill::capture
