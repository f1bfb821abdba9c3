#include "statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace raymill::bench {

Quartiles quartiles(std::vector<double> values) {
    assert(!values.empty());
    std::sort(values.begin(), values.end());
    const auto at = [&](double fraction) {
        const double place = fraction * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(place);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return std::lerp(values[below], values[above], place - static_cast<double>(below));
    };
    return {at(0.25), at(0.5), at(0.75)};
}

}  // namespace raymill::bench
