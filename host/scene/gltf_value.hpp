// Checked access to glTF's JSON: every fault names the file and the path of the property.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "scene/error.hpp"

namespace raymill {

/// A value of the document and where it stands, such as "meshes[0].primitives[1].mode". The document and the file's
/// name must outlive it. All members throw SceneError where the value is not what they are asked for.
class GltfValue {
  public:
    GltfValue(const nlohmann::json& json, std::string path, const std::string& file)
        : json_(&json), path_(std::move(path)), file_(&file) {}

    [[noreturn]] void fail(const std::string& message) const;
    const std::string& path() const { return path_; }

    /// The member of that name, if there is one. The value must be an object.
    std::optional<GltfValue> find(const std::string& key) const;
    /// The same for a member that must be there.
    GltfValue at(const std::string& key) const;
    /// The extension of that name, if the object has it.
    std::optional<GltfValue> extension(const std::string& name) const;
    /// An item of an array.
    GltfValue item(std::size_t index) const;
    /// The items of an array, or with their names the members of an object.
    std::vector<GltfValue> items() const;
    std::vector<std::pair<std::string, GltfValue>> members() const;

    double number(double least = -std::numeric_limits<double>::max(),
                  double most = std::numeric_limits<double>::max()) const;
    /// A whole number; 3.0 is one.
    std::uint64_t whole(std::uint64_t most = std::uint64_t{1} << 53) const;
    std::string text() const;
    bool flag() const;
    /// Exactly `count` numbers.
    std::vector<double> numbers(std::size_t count, double least = -std::numeric_limits<double>::max(),
                                double most = std::numeric_limits<double>::max()) const;

    double number_or(const std::string& key, double otherwise, double least, double most) const;
    std::uint64_t whole_or(const std::string& key, std::uint64_t otherwise) const;
    std::string text_or(const std::string& key, const std::string& otherwise) const;

  private:
    GltfValue below(const nlohmann::json& json, const std::string& step) const;

    const nlohmann::json* json_;
    std::string path_;
    const std::string* file_;
};

inline constexpr double gltf_infinity = std::numeric_limits<double>::max();  // JSON has no other

}  // namespace raymill
