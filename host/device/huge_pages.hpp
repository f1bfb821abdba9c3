// Large pages for memory that is read at random: fewer misses of the processor's address translation.
#pragma once

#include "device/device.hpp"

namespace raymill {

/// Asks for pages of 2 MiB for a buffer that nothing has been written to yet, where the device is this processor and the
/// buffer is worth it. A wish: where the system has none, all goes on as before.
void ask_for_huge_pages(const Device& device, const cl::Buffer& memory, std::size_t bytes);

}  // namespace raymill
