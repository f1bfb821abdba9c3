// glTF documents written by a test.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene_files.hpp"

namespace raymill {

/// A document of one buffer and one mesh, to which a test adds what it is about.
class GltfDocument {
  public:
    GltfDocument() {
        json["asset"]["version"] = "2.0";
        json["scene"] = 0;
        json["scenes"][0]["nodes"] = {0};
        json["nodes"][0] = {{"name", "it"}, {"mesh", 0}};
        json["meshes"][0]["primitives"][0]["attributes"] = nlohmann::json::object();
    }

    /// Adds an accessor over new bytes of the buffer and returns its index.
    template <class T>
    int accessor(const std::vector<T>& values, const char* type, int component_type, int count) {
        while (bytes_.size() % 4 != 0) bytes_ += '\0';
        const auto view = static_cast<int>(json["bufferViews"].size());
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}});
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        json["accessors"].push_back(
            {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
        return static_cast<int>(json["accessors"].size()) - 1;
    }
    int floats(const char* type, int count, const std::vector<float>& values) {
        return accessor(values, type, 5126, count);
    }
    nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }
    nlohmann::json& attribute(const char* name) { return primitive()["attributes"][name]; }

    /// The corners of a unit square in z = 0, counter-clockwise.
    void square() { attribute("POSITION") = floats("VEC3", 4, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}); }
    /// Two triangles over it.
    void square_faces() {
        square();
        primitive()["indices"] = accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 5123, 6);
    }

    /// With the buffer as a data: URI.
    std::string text() {
        if (!bytes_.empty()) json["buffers"][0] = {{"byteLength", bytes_.size()}, {"uri", data_uri(bytes_)}};
        return json.dump(1);
    }
    /// As GLB.
    std::string binary() {
        while (bytes_.size() % 4 != 0) bytes_ += '\0';
        json["buffers"][0] = {{"byteLength", bytes_.size()}};
        std::string document = json.dump();
        while (document.size() % 4 != 0) document += ' ';
        const auto total = static_cast<std::uint32_t>(12 + 8 + document.size() + 8 + bytes_.size());
        return "glTF" + number(2) + number(total) + number(static_cast<std::uint32_t>(document.size())) + "JSON" +
               document + number(static_cast<std::uint32_t>(bytes_.size())) + std::string("BIN\0", 4) + bytes_;
    }
    const std::string& bytes() const { return bytes_; }
    Scene load() { return SceneFiles().load("model.gltf", text()); }

    static std::string number(std::uint32_t value) {
        std::string text(4, '\0');
        std::memcpy(text.data(), &value, 4);
        return text;
    }
    static std::string data_uri(const std::string& bytes) {
        static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text = "data:application/octet-stream;base64,";
        for (std::size_t i = 0; i < bytes.size(); i += 3) {
            std::uint32_t bits = 0;
            for (std::size_t k = i; k < i + 3; ++k)
                bits = bits << 8 | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
            for (int shift = 18; shift >= 0; shift -= 6) text += digits[bits >> shift & 63];
        }
        for (std::size_t pad = (3 - bytes.size() % 3) % 3, i = 0; i < pad; ++i) text[text.size() - 1 - i] = '=';
        return text;
    }

    nlohmann::json json;

  private:
    std::string bytes_;
};

inline bool warns_of(const Scene& scene, const std::string& words) {
    for (const Diagnostic& warning : scene.warnings)
        if (warning.message.find(words) != std::string::npos) return true;
    return false;
}

}  // namespace raymill
