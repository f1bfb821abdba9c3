#include "device/program.hpp"

#include <fmt/format.h>

#include "device/kernel_source.hpp"

namespace raymill {

namespace {

/// Division and square roots must be rounded like the reference's; devices that do so anyway refuse the option.
/// RAYMILL_PROCESSOR: see kernels/lib/math.h.
std::string build_options(const Device& device) {
    std::string options = "-cl-std=CL1.2";
    if (device.device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)
        options += " -cl-fp32-correctly-rounded-divide-sqrt";
    if (device.info.type == "CPU") options += " -DRAYMILL_PROCESSOR";
    return options;
}

}  // namespace

cl::Program build_program(const Device& device, const std::vector<std::string>& files, const std::string& folder,
                          const std::string& definitions) {
    const std::string source = kernel_source(files, folder);
    try {
        cl::Program program(device.context, source);
        try {
            program.build({device.device}, (build_options(device) + " " + definitions).c_str());
        } catch (const cl::Error& error) {
            throw DeviceError(fmt::format("the kernels do not build on {} ({}):\n{}", device.info.name,
                                          status_name(error.err()),
                                          program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device)));
        }
        return program;
    } catch (const cl::Error& error) {
        throw DeviceError(error);
    }
}

cl::Kernel make_kernel(const cl::Program& program, const char* name) {
    try {
        return cl::Kernel(program, name);
    } catch (const cl::Error& error) {
        throw DeviceError(fmt::format("kernel {}: {} ({})", name, status_name(error.err()), error.err()));
    }
}

}  // namespace raymill
