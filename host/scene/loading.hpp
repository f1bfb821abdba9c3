// What every loader shares while a scene comes into being: the scene so far, the files read, the faults found.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/hash.hpp"
#include "scene/scene.hpp"

namespace raymill {

/// Reads whole files and hashes their bytes in the order of reading, each file followed by its size.
class InputFiles {
  public:
    /// The file's bytes, or nothing with the reason ("No such file or directory") where it cannot be read.
    std::optional<std::string> read(const std::string& path, std::string& reason);
    std::uint64_t hash() const { return hash_; }

  private:
    std::uint64_t hash_ = hash_start;
};

/// A scene while it is loaded. Loaders note faults and go on, so that the user sees all of them at once.
struct Loading {
    Scene scene;
    InputFiles files;
    std::vector<Diagnostic> errors;
    std::map<std::string, std::optional<std::uint32_t>> textures;  // by path; empty where it could not be loaded

    void error(SourcePosition position, std::string message);
    void warn(SourcePosition position, std::string message);
    /// Throws SceneError if there are errors: those of `main_file` first, in the order of its lines.
    void finish(const std::string& main_file);
};

/// `path` as seen from the folder of `file`; absolute paths stay as they are.
std::string path_beside(const std::string& file, const std::string& path);

/// The lower-case extension with its dot, or nothing.
std::string extension_of(const std::string& path);

}  // namespace raymill
