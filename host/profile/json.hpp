// A run's profile as JSON. docs/profile.md describes the keys.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "profile/profile.hpp"

namespace raymill::profile {

/// Keys in the order of docs/profile.md. Waves and launches only where the frame kept them.
nlohmann::ordered_json to_json(const RunProfile& run);

}  // namespace raymill::profile
