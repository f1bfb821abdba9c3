#include "allocations.hpp"

#include <CL/opencl.hpp>
#include <atomic>

namespace raymill {

namespace {

std::atomic<std::uint64_t>& total() {
    static std::atomic<std::uint64_t> bytes = 0;
    return bytes;
}

}  // namespace

std::uint64_t allocated_bytes() {
    return total();
}

}  // namespace raymill

// The names that the linker's --wrap option gives the caller's and the real function.
extern "C" {
cl_mem __real_clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* memory, cl_int* status);

cl_mem __wrap_clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* memory, cl_int* status) {
    raymill::total() += size;
    return __real_clCreateBuffer(context, flags, size, memory, status);
}
}
