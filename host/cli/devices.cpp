// raymill devices: what OpenCL offers here.
#include <fmt/format.h>

#include "cli/commands.hpp"
#include "device/device.hpp"
#include "wavefront/memory_plan.hpp"

namespace raymill {

namespace {

int devices() {
    const std::vector<DeviceInfo> infos = list_devices();
    if (infos.empty()) throw DeviceError("no OpenCL device was found. " + how_to_install_pocl());
    for (const DeviceInfo& info : infos) {
        fmt::print("{}: {} ({})\n", info.index, info.name, info.type);
        fmt::print("   platform       {}\n", info.platform);
        fmt::print("   version        {}, driver {}\n", info.version, info.driver);
        fmt::print("   compute units  {}, work-groups of at most {}\n", info.compute_units, info.largest_work_group);
        fmt::print("   memory         {}, buffers of at most {}, cache {}\n", human_bytes(info.global_memory),
                   human_bytes(info.largest_buffer), human_bytes(info.cache));
        fmt::print("   usable         {}\n", info.unusable.empty() ? "yes" : "no: " + info.unusable);
    }
    return 0;
}

}  // namespace

Command add_devices_command(CLI::App& app) {
    CLI::App& command = *app.add_subcommand("devices", "List the OpenCL platforms and devices");
    command.footer("The number before a device is what --device takes.");
    return devices;
}

}  // namespace raymill
