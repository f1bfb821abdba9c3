#include "wavefront/waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace raymill {

Waves::Waves(uint capacity, int max_depth) : capacity_(capacity), fill_(static_cast<std::size_t>(max_depth) + 1, 0) {
    assert(capacity >= 1 && max_depth >= 0);
}

void Waves::push(int depth, std::uint64_t count) {
    uint& fill = fill_.at(static_cast<std::size_t>(depth));
    if (fill != 0 || count > queue_size(depth))
        throw QueueOverflow(fmt::format("{} rays were pushed into the queue of depth {}, which holds {} and has {}",
                                        count, depth, queue_size(depth), fill));
    fill = static_cast<uint>(count);
}

std::optional<Batch> Waves::next() {
    for (int depth = static_cast<int>(fill_.size()) - 1; depth >= 0; --depth) {
        uint& fill = fill_[static_cast<std::size_t>(depth)];
        if (fill == 0) continue;
        const uint count = std::min(fill, capacity_);
        fill -= count;
        return Batch{depth, fill, count};
    }
    return std::nullopt;
}

}  // namespace raymill
