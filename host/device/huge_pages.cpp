#include "device/huge_pages.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstdint>

namespace raymill {

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;  // bytes

/// The whole huge pages in a range of memory.
void advise(void* memory, std::size_t bytes) {
#ifdef __linux__
    const std::uintptr_t start = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t first = (start + huge_page - 1) & ~(huge_page - 1), last = (start + bytes) & ~(huge_page - 1);
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#else
    (void)memory, (void)bytes;
#endif
}

}  // namespace

void ask_for_huge_pages(const Device& device, const cl::Buffer& memory, std::size_t bytes) {
    if (bytes < 2 * huge_page || device.info.type != "CPU") return;
    void* mapped = device.queue.enqueueMapBuffer(memory, CL_TRUE, CL_MAP_WRITE, 0, bytes);
    advise(mapped, bytes);
    device.queue.enqueueUnmapMemObject(memory, mapped);
}

}  // namespace raymill
