#include "device/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

namespace raymill {

namespace {

/// Items of a work-group lie on the stack of one thread (8 MiB at PoCL), with up to 6 KiB each.
constexpr std::size_t largest_work_group_of_processor = 512;

constexpr cl_int platform_not_found = -1001;  // CL_PLATFORM_NOT_FOUND_KHR, of the ICD loader

struct Found {
    DeviceInfo info;
    cl::Device device;
};

std::string type_name(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return "GPU";
    if (type & CL_DEVICE_TYPE_CPU) return "CPU";
    if (type & CL_DEVICE_TYPE_ACCELERATOR) return "accelerator";
    return "other";
}

std::string why_unusable(const cl::Device& device) {
    const std::string extensions = device.getInfo<CL_DEVICE_EXTENSIONS>();
    if (!device.getInfo<CL_DEVICE_AVAILABLE>()) return "the device is not available";
    if (!device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>()) return "the device has no compiler";
    if (!device.getInfo<CL_DEVICE_ENDIAN_LITTLE>()) return "the device is big-endian";
    for (const char* atomics : {"cl_khr_int64_base_atomics", "cl_khr_int64_extended_atomics"})
        if (extensions.find(atomics) == std::string::npos)
            return fmt::format("the device has no 64-bit integer atomics ({})", atomics);
    return {};
}

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device, int index) {
    DeviceInfo info;
    info.index = index;
    info.platform = platform.getInfo<CL_PLATFORM_NAME>();
    info.name = device.getInfo<CL_DEVICE_NAME>();
    info.version = device.getInfo<CL_DEVICE_VERSION>();
    info.driver = device.getInfo<CL_DRIVER_VERSION>();
    info.type = type_name(device.getInfo<CL_DEVICE_TYPE>());
    info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    info.global_memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    info.largest_buffer = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    info.constant_memory = device.getInfo<CL_DEVICE_MAX_CONSTANT_BUFFER_SIZE>();
    info.cache = device.getInfo<CL_DEVICE_GLOBAL_MEM_CACHE_SIZE>();
    info.largest_work_group = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
    if (info.type == "CPU")
        info.largest_work_group = std::min(info.largest_work_group, largest_work_group_of_processor);
    info.unusable = why_unusable(device);
    return info;
}

std::vector<Found> find_devices() {
    std::vector<cl::Platform> platforms;
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error& error) {
        if (error.err() == platform_not_found) return {};
        throw DeviceError(error);
    }
    std::vector<Found> found;
    for (const cl::Platform& platform : platforms) {
        std::vector<cl::Device> devices;
        try {
            platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
        } catch (const cl::Error& error) {
            if (error.err() != CL_DEVICE_NOT_FOUND) throw DeviceError(error);
        }
        for (const cl::Device& device : devices)
            found.push_back({describe(platform, device, static_cast<int>(found.size())), device});
    }
    return found;
}

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

bool matches(const DeviceInfo& info, const std::string& selector) {
    if (std::ranges::all_of(selector, [](unsigned char c) { return std::isdigit(c); }))
        return std::to_string(info.index) == selector;
    return lower(info.name + " " + info.platform).find(lower(selector)) != std::string::npos;
}

const Found& choose(const std::vector<Found>& found, const std::string& selector) {
    if (found.empty()) throw DeviceError("no OpenCL device was found. " + how_to_install_pocl());
    if (selector.empty()) {
        for (const char* type : {"GPU", "CPU", "accelerator", "other"})
            for (const Found& candidate : found)
                if (candidate.info.type == type && candidate.info.unusable.empty()) return candidate;
        throw DeviceError(fmt::format("no OpenCL device can be used: {}: {}. {}", found[0].info.name,
                                      found[0].info.unusable, how_to_install_pocl()));
    }
    for (const Found& candidate : found) {
        if (!matches(candidate.info, selector)) continue;
        if (candidate.info.unusable.empty()) return candidate;
        throw DeviceError(fmt::format("device {} ({}) cannot be used: {}", candidate.info.index, candidate.info.name,
                                      candidate.info.unusable));
    }
    throw DeviceError(fmt::format("no OpenCL device matches '{}': `raymill devices` lists them", selector));
}

cl::Device with_threads(const Found& found, unsigned threads) {
    if (threads == 0 || threads == found.info.compute_units) return found.device;
    if (threads > found.info.compute_units)
        throw DeviceError(fmt::format("device {} has {} compute units, not {}: lower --threads", found.info.name,
                                      found.info.compute_units, threads));
    const cl_device_partition_property by_count[] = {CL_DEVICE_PARTITION_BY_COUNTS,
                                                     static_cast<cl_device_partition_property>(threads),
                                                     CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    std::vector<cl::Device> parts;
    try {
        cl::Device(found.device).createSubDevices(by_count, &parts);
    } catch (const cl::Error& error) {
        throw DeviceError(fmt::format("device {} cannot be limited to {} threads ({}): leave --threads out",
                                      found.info.name, threads, status_name(error.err())));
    }
    return parts.at(0);
}

}  // namespace

std::string status_name(cl_int status) {
    switch (status) {
#define RAYMILL_STATUS(name) \
    case name: return #name;
        RAYMILL_STATUS(CL_DEVICE_NOT_FOUND)
        RAYMILL_STATUS(CL_DEVICE_NOT_AVAILABLE)
        RAYMILL_STATUS(CL_COMPILER_NOT_AVAILABLE)
        RAYMILL_STATUS(CL_MEM_OBJECT_ALLOCATION_FAILURE)
        RAYMILL_STATUS(CL_OUT_OF_RESOURCES)
        RAYMILL_STATUS(CL_OUT_OF_HOST_MEMORY)
        RAYMILL_STATUS(CL_BUILD_PROGRAM_FAILURE)
        RAYMILL_STATUS(CL_INVALID_VALUE)
        RAYMILL_STATUS(CL_INVALID_DEVICE)
        RAYMILL_STATUS(CL_INVALID_MEM_OBJECT)
        RAYMILL_STATUS(CL_INVALID_BUILD_OPTIONS)
        RAYMILL_STATUS(CL_INVALID_PROGRAM_EXECUTABLE)
        RAYMILL_STATUS(CL_INVALID_KERNEL_NAME)
        RAYMILL_STATUS(CL_INVALID_KERNEL_ARGS)
        RAYMILL_STATUS(CL_INVALID_ARG_SIZE)
        RAYMILL_STATUS(CL_INVALID_ARG_VALUE)
        RAYMILL_STATUS(CL_INVALID_WORK_GROUP_SIZE)
        RAYMILL_STATUS(CL_INVALID_BUFFER_SIZE)
#undef RAYMILL_STATUS
        case platform_not_found: return "CL_PLATFORM_NOT_FOUND_KHR";
        default: return "OpenCL status";
    }
}

DeviceError::DeviceError(const cl::Error& error)
    : std::runtime_error(fmt::format("{} failed: {} ({})", error.what(), status_name(error.err()), error.err())) {}

std::string how_to_install_pocl() {
    return "On Debian and Ubuntu, PoCL runs OpenCL on the processor: apt-get install pocl-opencl-icd";
}

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> infos;
    for (const Found& found : find_devices()) infos.push_back(found.info);
    return infos;
}

Device open_device(const std::string& selector, unsigned threads) {
    const std::vector<Found> found = find_devices();
    const Found& chosen = choose(found, selector);
    try {
        Device opened;
        opened.info = chosen.info;
        opened.device = with_threads(chosen, threads);
        opened.info.compute_units = opened.device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
        opened.context = cl::Context(opened.device);
        opened.queue = cl::CommandQueue(opened.context, opened.device, CL_QUEUE_PROFILING_ENABLE);
        return opened;
    } catch (const cl::Error& error) {
        throw DeviceError(error);
    }
}

}  // namespace raymill
