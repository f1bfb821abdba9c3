// The scheduler: which rays go next, so that memory is bounded and no ray is ever dropped.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "layout.h"

namespace raymill {

/// The invariant of the queues was broken: more rays were pushed than a queue holds. A defect, never the user's doing.
class QueueOverflow : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The books of the queues do not balance: some item was pushed and never popped, or popped twice. A defect as well.
class QueueMismatch : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Rays [first, first + count) of the queue of `depth`.
struct Batch {
    int depth = 0;
    uint first = 0;
    uint count = 0;
};

/// What went through the queue of a depth.
struct QueueCounts {
    std::uint64_t pushed = 0;
    std::uint64_t popped = 0;
    std::uint64_t batches = 0;
    uint high_water = 0;  // most rays that it ever held
};

/// Fill levels of the queues. Rays gather until they are half a batch, and the deepest queue that has so many goes
/// first; so no deeper one has, and a batch's children (at most two a ray) fit behind those that wait in a queue of
/// twice the capacity, if the batch leaves out a quarter at most. Once no camera rays are to come, the shallowest of the
/// queues with less than half a batch goes next: its children join those that wait.
class Waves {
  public:
    /// capacity: largest batch, at least 1. max_depth: of the deepest rays.
    Waves(uint capacity, int max_depth);

    /// Rays that the queue of a depth holds.
    std::uint64_t queue_size(int depth) const { return depth == 0 ? capacity_ : 2 * std::uint64_t{capacity_}; }

    /// Rays were pushed behind those that wait at `depth`. Throws QueueOverflow if they cannot have fitted.
    void push(int depth, std::uint64_t count);

    /// Takes the next batch, from the end of its queue. Nothing if it is better to push camera rays first, of which
    /// `camera_rays` are to come, or if there is nothing left to do.
    std::optional<Batch> next(std::uint64_t camera_rays);

    /// Rays that wait at `depth`.
    uint waiting(int depth) const { return fill_.at(static_cast<std::size_t>(depth)); }

    /// How many of the camera rays to come may be pushed at once, in whole chunks where there are more: one at least,
    /// when next() has given nothing. They are the next batch.
    uint camera_batch(std::uint64_t camera_rays) const;

    int max_depth() const { return static_cast<int>(fill_.size()) - 1; }
    /// Since construction or the last start().
    const QueueCounts& counts(int depth) const { return counts_.at(static_cast<std::size_t>(depth)); }
    /// Forgets the counts, and what waits in the queues.
    void start();
    /// Throws QueueMismatch unless every ray that was pushed has been popped.
    void check_drained() const;

  private:
    /// The largest batch of a depth whose children surely fit.
    uint largest_batch(int depth) const;
    Batch take(int depth);

    uint capacity_;
    std::vector<uint> fill_;  // rays waiting, by depth
    std::vector<QueueCounts> counts_;
};

}  // namespace raymill
