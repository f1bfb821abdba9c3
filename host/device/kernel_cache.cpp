#include "device/kernel_cache.hpp"

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <system_error>

namespace raymill {

namespace {

namespace fs = std::filesystem;

/// .../NAME/SIZE/NAME.so
bool is_kernel(const fs::path& file) {
    return file.extension() == ".so" && file.parent_path().parent_path().filename() == file.stem() &&
           !file.stem().empty();
}

}  // namespace

std::vector<LoadedKernel> loaded_kernels(const std::string& memory_map, fs::file_time_type since) {
    std::vector<LoadedKernel> kernels;
    std::set<fs::path> seen;
    std::istringstream lines(memory_map);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t place = line.find('/');
        if (place == std::string::npos) continue;
        const fs::path file = line.substr(place);
        if (!is_kernel(file) || !seen.insert(file).second) continue;
        std::error_code missing;
        const fs::file_time_type written = fs::last_write_time(file, missing);
        kernels.push_back({file.stem().string(), file, missing || written >= since});
    }
    return kernels;
}

std::vector<LoadedKernel> loaded_kernels(fs::file_time_type since) {
    std::ifstream map("/proc/self/maps");
    return loaded_kernels(std::string(std::istreambuf_iterator<char>(map), {}), since);
}

}  // namespace raymill
