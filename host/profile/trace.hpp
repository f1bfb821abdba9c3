// A run's profile for Perfetto and chrome://tracing.
#pragma once

#include <iosfwd>

#include "profile/profile.hpp"

namespace raymill::profile {

/// Writes Chrome's trace event format: spans on a track of the host, launches on a track of the device, and the fill of
/// each depth's queue as a counter. Needs a frame with Detail::launches.
/// Source: "Trace Event Format" (Google, 2016).
void write_trace(std::ostream& out, const RunProfile& run);

}  // namespace raymill::profile
