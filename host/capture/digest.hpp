// Fingerprints of what a stage wrote: the same for any order in which its work-items ran, other for any other bit.
#pragma once

#include <cstdint>
#include <span>

#include "wavefront/stages.hpp"

namespace raymill::capture {

/// queue: the items that the stage pushed, or the hits; film: every sum, and the counters.
struct Digest {
    std::uint64_t queue = 0;
    std::uint64_t film = 0;
    bool operator==(const Digest&) const = default;
};

/// Rays name their pixel, sample and path, so their order in the queue does not count: it depends on threads.
std::uint64_t digest_of(std::span<const Ray> rays);
/// Nor does that of shadow rays, which depends on how a batch is cut into chunks.
std::uint64_t digest_of(std::span<const ShadowRay> rays);
/// Of the hits of rays [first, first + hits.size()): each counts with its place. Digests of parts add up to the
/// whole's.
std::uint64_t digest_of(std::span<const Hit> hits, std::uint64_t first = 0);

std::uint64_t digest_of(std::span<const cl_long> sums, const Counters& counters);

}  // namespace raymill::capture
