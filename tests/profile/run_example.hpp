// A small profile written by hand, for what is made of profiles.
#pragma once

#include "profile/profile.hpp"

namespace raymill::profile {

/// Two waves: 100 camera rays, of which 30 miss, 20 end and 50 have 60 children; these all miss. Two passes over the
/// light samples at depth 0, one shadow ray a hit in each, 15 of 140 blocked.
RunProfile run_example();

}  // namespace raymill::profile
