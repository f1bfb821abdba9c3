#include "scene/loading.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <tuple>

namespace raymill {

namespace fs = std::filesystem;

std::optional<std::string> InputFiles::read(const std::string& path, std::string& reason) {
    std::error_code code;
    const fs::file_status status = fs::status(path, code);
    if (!fs::exists(status)) {
        reason = code ? code.message() : std::strerror(ENOENT);
        return std::nullopt;
    }
    if (!fs::is_regular_file(status)) {  // a pipe or a device might never end
        reason = fs::is_directory(status) ? "it is a folder" : "it is not a regular file";
        return std::nullopt;
    }
    std::ifstream stream(path, std::ios::binary);
    const std::uintmax_t size = fs::file_size(path, code);
    if (!stream || code) {
        reason = std::strerror(errno);
        return std::nullopt;
    }
    std::string bytes(size, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));

    std::uint64_t word = 0;
    std::size_t hashed = 0;
    for (; hashed + sizeof word <= bytes.size(); hashed += sizeof word) {
        std::memcpy(&word, bytes.data() + hashed, sizeof word);
        hash_ = hash_add(hash_, word);
    }
    word = 0;
    std::memcpy(&word, bytes.data() + hashed, bytes.size() - hashed);
    hash_ = hash_add(hash_, word);
    hash_ = hash_add(hash_, bytes.size());  // tells "ab" + "c" from "a" + "bc"
    return bytes;
}

void Loading::error(SourcePosition position, std::string message) {
    errors.push_back({std::move(position), std::move(message)});
}

void Loading::warn(SourcePosition position, std::string message) {
    scene.warnings.push_back({std::move(position), std::move(message)});
}

void Loading::finish(const std::string& main_file) {
    if (errors.empty()) return;
    const auto rank = [&](const Diagnostic& d) {
        const bool elsewhere = d.position.file != main_file;
        return std::tuple(elsewhere, elsewhere ? 0 : d.position.line, elsewhere ? 0 : d.position.column);
    };
    std::stable_sort(errors.begin(), errors.end(),
                     [&](const Diagnostic& a, const Diagnostic& b) { return rank(a) < rank(b); });
    throw SceneError(std::move(errors));
}

std::string path_beside(const std::string& file, const std::string& path) {
    return (fs::path(file).parent_path() / path).string();
}

std::string extension_of(const std::string& path) {
    std::string extension = fs::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace raymill
