// Medians and quartiles of a few measurements.
#pragma once

#include <vector>

namespace raymill::profile {

struct Quartiles {
    double lower = 0;
    double median = 0;
    double upper = 0;
};

/// Quartiles with linear interpolation between the order statistics (type 7 of Hyndman and Fan, 1996).
/// values: at least one, in any order.
Quartiles quartiles(std::vector<double> values);

/// values: at least one, all positive.
double geometric_mean(const std::vector<double>& values);

}  // namespace raymill::profile
