// A small sweep written by hand.
#pragma once

#include "profile/sweep.hpp"

namespace raymill::profile {

/// Capacities 64, 128, 256 and 512 with work-group auto, and 128 with work-group 8, all of 1200 rays; two frames each,
/// all with the same hash. Million rays a second of the medians: 60, 96, 100, skipped; 80.
Sweep sweep_example();

/// A setting of 1200 rays with a frame of each duration.
SweepSetting setting_of(std::uint64_t capacity, std::uint64_t work_group, const std::vector<double>& seconds);

}  // namespace raymill::profile
