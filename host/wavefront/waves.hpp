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

/// Rays [first, first + count) of the queue of `depth`.
struct Batch {
    int depth = 0;
    uint first = 0;
    uint count = 0;
};

/// Fill levels of the queues. A batch is taken from the end of the deepest queue that is not empty; since all deeper
/// ones are empty then, its children (at most two a ray) fit a queue of twice the capacity.
class Waves {
  public:
    /// capacity: largest batch, at least 1. max_depth: of the deepest rays.
    Waves(uint capacity, int max_depth);

    /// Rays that the queue of a depth holds.
    std::uint64_t queue_size(int depth) const { return depth == 0 ? capacity_ : 2 * std::uint64_t{capacity_}; }

    /// Rays were pushed into the queue of depth `depth`, which was empty. Throws QueueOverflow if they cannot have fitted.
    void push(int depth, std::uint64_t count);

    /// Takes the next batch; nothing when all queues are empty.
    std::optional<Batch> next();

  private:
    uint capacity_;
    std::vector<uint> fill_;  // rays waiting, by depth
};

}  // namespace raymill
