// OpenCL devices: what there is, choosing one, and the errors of the runtime as sentences.
#pragma once

#include <CL/opencl.hpp>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace raymill {

/// The device cannot do what is asked: none there, a kernel does not build, memory runs out. Exit status 1.
class DeviceError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
    /// A failed OpenCL call as "clName failed: CL_CODE_BY_NAME (-n)".
    explicit DeviceError(const cl::Error& error);
};

/// Name of an OpenCL status code, for example "CL_OUT_OF_RESOURCES".
std::string status_name(cl_int status);

struct DeviceInfo {
    int index = 0;  // what --device takes
    std::string platform;
    std::string name;
    std::string version;
    std::string driver;
    std::string type;  // "CPU", "GPU", "accelerator" or "other"
    unsigned compute_units = 0;
    std::uint64_t global_memory = 0;      // bytes
    std::uint64_t largest_buffer = 0;     // bytes
    std::uint64_t constant_memory = 0;    // bytes
    std::uint64_t cache = 0;              // bytes of global memory cache, as the device tells
    std::size_t largest_work_group = 0;   // that Raymill's kernels run with
    std::string unusable;  // why Raymill cannot use it; empty if it can
};

/// All devices of all platforms; empty where there are none. Throws DeviceError if the runtime fails otherwise.
std::vector<DeviceInfo> list_devices();

/// The sentence for a machine without OpenCL: how to install PoCL.
std::string how_to_install_pocl();

/// A device that is ready to work: one in-order queue.
struct Device {
    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
};

/// Opens the device whose index or part of whose name `selector` is; empty: the first usable GPU, else the first usable one.
/// threads > 0 uses that many of its compute units. Throws DeviceError.
Device open_device(const std::string& selector, unsigned threads);

}  // namespace raymill
