#include "profile/timeline.hpp"

#include <chrono>

namespace raymill::profile {

std::int64_t now() {
    const auto since_epoch = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count();
}

}  // namespace raymill::profile
