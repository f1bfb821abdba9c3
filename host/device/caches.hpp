// The caches of the processor that this program runs on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raymill {

struct ProcessorCache {
    std::string name;         // "L1d", "L2", "L3"
    std::uint64_t bytes = 0;  // of one such cache
    unsigned sharers = 1;     // hardware threads that share it
};

/// Data caches of the first hardware thread, from the smallest level on; empty where the system does not tell.
/// folder: what Linux keeps for it (sysfs, Documentation/ABI/testing/sysfs-devices-system-cpu).
std::vector<ProcessorCache> processor_caches(const std::string& folder = "/sys/devices/system/cpu/cpu0/cache");

/// Hardware threads in a list such as "0-3,8"; 1 if it is none.
unsigned count_threads(const std::string& list);

}  // namespace raymill
