// The kernels, built for a device.
#pragma once

#include <string>

#include "device/device.hpp"

namespace raymill {

/// Builds kernel files (with their includes) for the device. Throws DeviceError with the build log.
/// folder: where to read them from; empty: those embedded in this program.
/// definitions: compiler options such as "-DNAME".
cl::Program build_program(const Device& device, const std::vector<std::string>& files, const std::string& folder,
                          const std::string& definitions = {});

/// A kernel by name. Throws DeviceError.
cl::Kernel make_kernel(const cl::Program& program, const char* name);

}  // namespace raymill
