// A hash of many words, for telling whether they are the same; not against anyone who wants them to seem so.
#pragma once

#include <cstdint>

namespace raymill {

inline constexpr std::uint64_t hash_start = 0xcbf29ce484222325u;

/// Like FNV-1a, but a word of 64 bits a step.
constexpr std::uint64_t hash_add(std::uint64_t hash, std::uint64_t word) {
    hash = (hash ^ word) * 0x100000001b3u;
    return hash ^ hash >> 32;  // else high bits would never come down
}

}  // namespace raymill
