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
    if (fill != 0 || count > queue_size(depth))
        throw QueueOverflow(fmt::format("{} rays were pushed into the queue of depth {}, which holds {} and has {}",
                                        count, depth, queue_size(depth), fill));
    fill = static_cast<uint>(count);
    QueueCounts& counts = counts_[static_cast<std::size_t>(depth)];
    counts.pushed += count;
    counts.high_water = std::max(counts.high_water, fill);
}

std::optional<Batch> Waves::next() {
    for (int depth = static_cast<int>(fill_.size()) - 1; depth >= 0; --depth) {
        uint& fill = fill_[static_cast<std::size_t>(depth)];
        if (fill == 0) continue;
        const uint count = std::min(fill, capacity_);
        fill -= count;
        QueueCounts& counts = counts_[static_cast<std::size_t>(depth)];
        counts.popped += count;
        ++counts.batches;
        return Batch{depth, fill, count};
    }
    return std::nullopt;
}

void Waves::start() {
    std::ranges::fill(counts_, QueueCounts{});
}

void Waves::check_drained() const {
    for (int depth = 0; depth <= max_depth(); ++depth)
        if (counts(depth).pushed != counts(depth).popped)
            throw QueueMismatch(fmt::format("{} rays were pushed into the queue of depth {} and {} popped",
                                            counts(depth).pushed, depth, counts(depth).popped));
}

}  // namespace raymill
