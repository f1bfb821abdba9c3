// A run's profile as a table to read.
#pragma once

#include <string>

#include "profile/profile.hpp"

namespace raymill::profile {

/// Lines of at most 120 columns: where the time went, what each stage did, and how the rays of each depth went on.
std::string table(const RunProfile& run);

}  // namespace raymill::profile
