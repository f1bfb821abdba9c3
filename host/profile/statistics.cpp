#include "profile/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace raymill::profile {

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

double geometric_mean(const std::vector<double>& values) {
    assert(!values.empty());
    double sum = 0;
    for (const double value : values) sum += std::log(value);
    return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace raymill::profile
