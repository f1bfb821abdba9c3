#include "scene/gltf_value.hpp"

#include <fmt/format.h>

namespace raymill {

void GltfValue::fail(const std::string& message) const {
    throw SceneError({*file_}, fmt::format("{} {}", path_.empty() ? "the document" : path_, message));
}

GltfValue GltfValue::below(const nlohmann::json& json, const std::string& step) const {
    const bool joins = path_.empty() || step.starts_with('[');
    return {json, fmt::format("{}{}{}", path_, joins ? "" : ".", step), *file_};
}

std::optional<GltfValue> GltfValue::find(const std::string& key) const {
    if (!json_->is_object()) fail("must be an object");
    const auto found = json_->find(key);
    if (found == json_->end()) return std::nullopt;
    return below(*found, key);
}

GltfValue GltfValue::at(const std::string& key) const {
    const std::optional<GltfValue> found = find(key);
    if (!found) fail(fmt::format("must have the property \"{}\"", key));
    return *found;
}

std::optional<GltfValue> GltfValue::extension(const std::string& name) const {
    const std::optional<GltfValue> extensions = find("extensions");
    if (!extensions) return std::nullopt;
    std::optional<GltfValue> extension = extensions->find(name);
    if (extension && !extension->json_->is_object()) extension->fail("must be an object");
    return extension;
}

GltfValue GltfValue::item(std::size_t index) const {
    if (!json_->is_array() || index >= json_->size()) fail(fmt::format("must be an array with an item {}", index));
    return below((*json_)[index], fmt::format("[{}]", index));
}

std::vector<GltfValue> GltfValue::items() const {
    if (!json_->is_array()) fail("must be an array");
    std::vector<GltfValue> values;
    values.reserve(json_->size());
    for (std::size_t i = 0; i < json_->size(); ++i) values.push_back(item(i));
    return values;
}

std::vector<std::pair<std::string, GltfValue>> GltfValue::members() const {
    if (!json_->is_object()) fail("must be an object");
    std::vector<std::pair<std::string, GltfValue>> values;
    for (const auto& [key, value] : json_->items()) values.emplace_back(key, below(value, key));
    return values;
}

double GltfValue::number(double least, double most) const {
    if (!json_->is_number()) fail("must be a number");
    const auto value = json_->get<double>();
    if (value >= least && value <= most) return value;
    if (most == gltf_infinity) fail(fmt::format("is {}, but must be at least {}", value, least));
    fail(fmt::format("is {}, but must be from {} to {}", value, least, most));
}

std::uint64_t GltfValue::whole(std::uint64_t most) const {
    if (!json_->is_number()) fail("must be a whole number");
    const auto value = json_->get<double>();
    if (!(value >= 0 && value == std::floor(value) && value <= static_cast<double>(most)))
        fail(fmt::format("is {}, but must be a whole number from 0 to {}", value, most));
    return static_cast<std::uint64_t>(value);
}

std::string GltfValue::text() const {
    if (!json_->is_string()) fail("must be a string");
    return json_->get<std::string>();
}

bool GltfValue::flag() const {
    if (!json_->is_boolean()) fail("must be true or false");
    return json_->get<bool>();
}

std::vector<double> GltfValue::numbers(std::size_t count, double least, double most) const {
    const std::vector<GltfValue> values = items();
    if (values.size() != count) fail(fmt::format("must be {} numbers, not {}", count, values.size()));
    std::vector<double> result;
    for (const GltfValue& value : values) result.push_back(value.number(least, most));
    return result;
}

double GltfValue::number_or(const std::string& key, double otherwise, double least, double most) const {
    const std::optional<GltfValue> found = find(key);
    return found ? found->number(least, most) : otherwise;
}

std::uint64_t GltfValue::whole_or(const std::string& key, std::uint64_t otherwise) const {
    const std::optional<GltfValue> found = find(key);
    return found ? found->whole() : otherwise;
}

std::string GltfValue::text_or(const std::string& key, const std::string& otherwise) const {
    const std::optional<GltfValue> found = find(key);
    return found ? found->text() : otherwise;
}

}  // namespace raymill
