// One way to trace a set of rays, as both sides offer it to the measurement.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raymill::bench {

struct Variant {
    std::string name;
    bool ours = false;
    /// Reads every ray from memory and writes every result to memory, on all threads; back when all is done.
    std::function<void()> trace;
    /// What the last trace found, ray by ray: the primitive's id or NO_INDEX; for any-hit sets 1 where blocked, else 0.
    std::function<std::vector<std::uint32_t>()> found;
};

/// What building a hierarchy took.
struct Build {
    double seconds = 0;     // wall clock
    std::size_t bytes = 0;  // of the hierarchy and of the primitives that rays read with it
};

}  // namespace raymill::bench
