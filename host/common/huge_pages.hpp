// Large pages for large memory: fewer misses of the processor's address translation, and fewer first touches, each of
// which costs a small page a microsecond.
#pragma once

#include <cstddef>
#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace raymill {

inline constexpr std::size_t HUGE_PAGE = std::size_t{1} << 21;  // bytes

/// Asks for huge pages for as much of a range as is whole ones, before it is first touched. A wish, and no error where
/// it is not granted.
inline void ask_for_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
    const auto start = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t first = (start + HUGE_PAGE - 1) & ~(HUGE_PAGE - 1), last = (start + bytes) & ~(HUGE_PAGE - 1);
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

}  // namespace raymill
