// Counts the device memory that the program under test asks OpenCL for.
#pragma once

#include <cstdint>

namespace raymill {

/// Bytes of all buffers created since the program started; the linker sends clCreateBuffer here first.
std::uint64_t allocated_bytes();

}  // namespace raymill
