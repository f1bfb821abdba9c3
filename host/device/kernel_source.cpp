#include "device/kernel_source.hpp"

#include <fmt/format.h>

#include <fstream>
#include <set>
#include <sstream>

#include "device/device.hpp"

namespace raymill {

namespace {

std::string read_kernel(const std::string& name, const std::string& folder) {
    if (folder.empty()) {
        for (const KernelFile& file : embedded_kernels())
            if (file.name == name) return std::string(file.text);
        throw DeviceError(fmt::format("kernel file {} is not part of this program", name));
    }
    const std::string path = folder + "/" + name;
    std::ifstream in(path, std::ios::binary);
    if (!in) throw DeviceError(fmt::format("cannot read kernel file {}: give --kernel-dir the folder kernels/", path));
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The name in a line `#include "name"`, or nothing.
std::string included_name(const std::string& line) {
    constexpr std::string_view directive = "#include \"";
    if (!line.starts_with(directive)) return {};
    return line.substr(directive.size(), line.find('"', directive.size()) - directive.size());
}

void expand(const std::string& name, const std::string& folder, std::set<std::string>& seen, std::string& out) {
    if (!seen.insert(name).second) return;
    std::istringstream text(read_kernel(name, folder));
    out += fmt::format("#line 1 \"{}\"\n", name);
    int number = 0;
    for (std::string line; std::getline(text, line);) {
        ++number;
        const std::string included = included_name(line);
        if (included.empty()) {
            out += line + "\n";
        } else {
            expand(included, folder, seen, out);
            out += fmt::format("#line {} \"{}\"\n", number + 1, name);
        }
    }
}

}  // namespace

std::string kernel_source(const std::vector<std::string>& files, const std::string& folder) {
    std::set<std::string> seen;
    std::string source;
    for (const std::string& file : files) expand(file, folder, seen, source);
    return source;
}

}  // namespace raymill
