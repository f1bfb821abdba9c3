#include "wavefront/waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace raymill {

Waves::Waves(uint capacity, int max_depth)
    : capacity_(capacity), fill_(static_cast<std::size_t>(max_depth) + 1, 0), counts_(fill_.size()) {
    assert(capacity >= 1 && max_depth >= 0);
}

void Waves::push(int depth, std::uint64_t count) {
    uint& fill = fill_.at(static_cast<std::size_t>(depth));
    if (fill + count > queue_size(depth))
        throw QueueOverflow(fmt::format("{} rays were pushed into the queue of depth {}, which holds {} and has {}",
                                        count, depth, queue_size(depth), fill));
    fill += static_cast<uint>(count);
    QueueCounts& counts = counts_[static_cast<std::size_t>(depth)];
    counts.pushed += count;
    counts.high_water = std::max(counts.high_water, fill);
}

uint Waves::largest_batch(int depth) const {
    if (depth == max_depth()) return capacity_;
    return std::min<std::uint64_t>(capacity_, (queue_size(depth + 1) - waiting(depth + 1)) / 2);
}

Batch Waves::take(int depth) {
    uint& fill = fill_[static_cast<std::size_t>(depth)];
    const uint count = std::min(fill, largest_batch(depth));
    fill -= count;
    QueueCounts& counts = counts_[static_cast<std::size_t>(depth)];
    counts.popped += count;
    ++counts.batches;
    return Batch{depth, fill, count};
}

std::optional<Batch> Waves::next(std::uint64_t camera_rays) {
    const uint enough = (capacity_ + 1) / 2;
    for (int depth = max_depth(); depth >= 0; --depth)
        if (waiting(depth) >= enough) return take(depth);
    if (camera_rays > 0 && waiting(0) == 0) return std::nullopt;
    for (int depth = 0; depth <= max_depth(); ++depth)
        if (waiting(depth) > 0) return take(depth);
    return std::nullopt;
}

uint Waves::camera_batch(std::uint64_t camera_rays) const {
    const auto count = static_cast<uint>(std::min<std::uint64_t>(largest_batch(0), camera_rays));
    return count < camera_rays && count > CHUNK ? count - count % CHUNK : count;
}

void Waves::start() {
    std::ranges::fill(fill_, 0u);
    std::ranges::fill(counts_, QueueCounts{});
}

void Waves::check_drained() const {
    for (int depth = 0; depth <= max_depth(); ++depth)
        if (counts(depth).pushed != counts(depth).popped)
            throw QueueMismatch(fmt::format("{} rays were pushed into the queue of depth {} and {} popped",
                                            counts(depth).pushed, depth, counts(depth).popped));
}

}  // namespace raymill
