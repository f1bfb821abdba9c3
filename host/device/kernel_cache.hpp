// Which compiled kernels a run built, and which it found in the runtime's cache.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace raymill {

/// A compiled kernel that this process has loaded.
struct LoadedKernel {
    std::string name;
    std::filesystem::path file;
    bool built = false;  // its file is younger than `since`: this run compiled it
};

/// PoCL loads each kernel (and local size) as a shared library NAME/SIZE/NAME.so from its cache on disk, after
/// compiling it there if it is missing. So the process's memory map names all that it uses, and the time of each file
/// tells whether it was there before. Empty for other runtimes and systems, which cannot be watched like this.
std::vector<LoadedKernel> loaded_kernels(std::filesystem::file_time_type since);

/// The same for the text of a memory map (Linux, proc(5)); a file that does not exist counts as built.
std::vector<LoadedKernel> loaded_kernels(const std::string& memory_map, std::filesystem::file_time_type since);

}  // namespace raymill
