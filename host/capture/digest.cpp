#include "capture/digest.hpp"

#include <bit>
#include <cstring>

namespace raymill::capture {

namespace {

/// A bijection of 64 bits that mixes each into all; the finaliser of SplitMix64 (Steele, Lea, Flood, 2014).
std::uint64_t mix(std::uint64_t h) {
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

std::uint64_t chain(std::uint64_t h, std::uint64_t word) {
    return mix((h ^ word) + 0x9e3779b97f4a7c15u);
}

/// All bits of an item that consists of 32-bit words, as all of layout.h's queue items do.
template <class Item>
std::uint64_t item_digest(const Item& item, std::uint64_t start) {
    static_assert(sizeof(Item) % sizeof(std::uint32_t) == 0);
    std::uint32_t words[sizeof(Item) / sizeof(std::uint32_t)];
    std::memcpy(words, &item, sizeof item);
    std::uint64_t h = start;
    for (const std::uint32_t word : words) h = chain(h, word);
    return h;
}

// Sums have no order, and unlike exclusive or they tell two equal items from none.
template <class Item>
std::uint64_t unordered(std::span<const Item> items) {
    std::uint64_t sum = 0;
    for (const Item& item : items) sum += item_digest(item, 1);
    return sum;
}

}  // namespace

std::uint64_t digest_of(std::span<const Ray> rays) {
    return unordered(rays);
}

std::uint64_t digest_of(std::span<const ShadowRay> rays) {
    return unordered(rays);
}

std::uint64_t digest_of(std::span<const Hit> hits, std::uint64_t first) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) sum += item_digest(hits[i], mix(first + i + 1));
    return sum;
}

std::uint64_t digest_of(std::span<const cl_long> sums, const Counters& counters) {
    std::uint64_t sum = item_digest(counters, 2);
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (sums[i] != 0) sum += chain(mix(i + 1), std::bit_cast<std::uint64_t>(sums[i]));
    return sum;
}

}  // namespace raymill::capture
