// Scenes and meshes written by a test.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "scene/scene.hpp"

namespace raymill {

/// A folder of files that vanishes at the end of the scope.
class SceneFiles {
  public:
    SceneFiles() {
        std::string name = (std::filesystem::temp_directory_path() / "raymill-scene-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::system_error(errno, std::generic_category(), name);
        folder_ = name;
    }
    ~SceneFiles() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    SceneFiles(const SceneFiles&) = delete;
    SceneFiles& operator=(const SceneFiles&) = delete;

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// Writes the file and returns its path.
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return path(name);
    }
    Scene load(const std::string& name, const std::string& text) const { return load_scene(write(name, text)); }
    Scene toml(const std::string& text) const { return load("scene.toml", text); }
    Scene obj(const std::string& text) const { return load("model.obj", text); }

    /// The faults of a scene file as "line:column: message", without the file's name.
    std::vector<std::string> faults(const std::string& text) const {
        const std::string file = write("scene.toml", text);
        try {
            load_scene(file);
        } catch (const SceneError& error) {
            std::vector<std::string> lines;
            for (const Diagnostic& diagnostic : error.diagnostics()) {
                std::string line = to_string(diagnostic);
                if (line.starts_with(file + ":")) line.erase(0, file.size() + 1);
                lines.push_back(line);
            }
            return lines;
        }
        return {};
    }

  private:
    std::filesystem::path folder_;
};

inline glm::vec3 vec(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

inline glm::vec3 position(const Scene& scene, const Triangle& triangle, int corner) {
    return vec(scene.vertices[triangle.vertex[corner]].position);
}

inline glm::vec3 vertex_normal(const Scene& scene, const Triangle& triangle, int corner) {
    return vec(scene.vertices[triangle.vertex[corner]].normal);
}

/// The face's unit normal by its winding.
inline glm::vec3 face_normal(const Scene& scene, const Triangle& triangle) {
    const glm::vec3 a = position(scene, triangle, 0);
    return glm::normalize(glm::cross(position(scene, triangle, 1) - a, position(scene, triangle, 2) - a));
}

}  // namespace raymill
