// Where the kernels' text comes from: embedded in the program, or a folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raymill {

/// A file under kernels/, named relative to it.
struct KernelFile {
    std::string_view name;
    std::string_view text;
};

/// Every kernel file of the build.
const std::vector<KernelFile>& embedded_kernels();

/// One translation unit of the named files with their includes expanded, each once, and #line directives so that a build
/// log names the right place. Read from `folder` if that is not empty, else embedded.
/// Throws DeviceError if a file is missing.
std::string kernel_source(const std::vector<std::string>& files, const std::string& folder);

}  // namespace raymill
