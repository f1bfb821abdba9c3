#include "scene/toml_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace raymill {
namespace {

/// "a number", "text": how an error names what stands there.
std::string_view kind_of(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table:
            return "a table";
        case toml::node_type::array:
            return "a list";
        case toml::node_type::string:
            return "text";
        case toml::node_type::integer:
            return "a whole number";
        case toml::node_type::floating_point:
            return "a number";
        case toml::node_type::boolean:
            return "true or false";
        default:
            return "a date or time";
    }
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                cost[i][j] = i + j;
                continue;
            }
            const std::size_t replaced = cost[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    return cost[a.size()][b.size()];
}

}  // namespace

std::string Range::rule() const {
    constexpr double limit = std::numeric_limits<float>::max();
    if (lower == -limit && upper == limit) return "must be a number that a 32-bit float can hold";
    if (upper == limit) return fmt::format("must be {} {}", open_lower ? "above" : "at least", lower);
    if (open_lower && open_upper) return fmt::format("must lie between {} and {}, both excluded", lower, upper);
    if (open_lower) return fmt::format("must be above {} and at most {}", lower, upper);
    return fmt::format("must lie between {} and {}", lower, upper);
}

bool Range::contains(double value) const {
    const bool above_lower = open_lower ? value > lower && static_cast<float>(value) > lower : value >= lower;
    const bool below_upper = open_upper ? value < upper && static_cast<float>(value) < upper : value <= upper;
    return above_lower && below_upper && std::abs(value) <= std::numeric_limits<float>::max();
}

std::string nearest_name(std::string_view word, const std::vector<std::string>& known) {
    constexpr std::size_t longest = 64;  // a name beyond it is no slip of the hand
    if (word.size() > longest) return {};
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string& name : known) {
        if (name.size() > longest) continue;
        const std::size_t distance = edit_distance(word, name);
        if (distance < best_distance) {
            best_distance = distance;
            best = name;
        }
    }
    return best;
}

TableReader::TableReader(Loading& loading, std::string file, const toml::table& table, std::string subject)
    : loading_(loading), file_(std::move(file)), table_(table), subject_(std::move(subject)) {}

SourcePosition TableReader::place(const toml::source_region& region) const {
    return {file_, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

SourcePosition TableReader::position_of(std::string_view key) const {
    const toml::node* node = table_.get(key);
    return place(node ? node->source() : table_.source());
}

const toml::node* TableReader::find(std::string_view key) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
    return table_.get(key);
}

bool TableReader::has(std::string_view key) {
    return find(key) != nullptr;
}

bool TableReader::require(std::initializer_list<std::string_view> keys) {
    bool all = true;
    for (const std::string_view key : keys) {
        if (has(key)) continue;
        loading_.error(position(), fmt::format("{}: the key \"{}\" is missing", subject_, key));
        all = false;
    }
    return all;
}

void TableReader::error(std::string_view key, const std::string& message) {
    loading_.error(position_of(key), fmt::format("{}: {} {}", subject_, key, message));
}

void TableReader::error_at(const toml::node& node, const std::string& message) {
    loading_.error(place(node.source()), fmt::format("{}: {}", subject_, message));
}

bool TableReader::read_number(std::string_view key, const toml::node& node, const Range& range, double& value) {
    if (!node.is_number()) {
        error_at(node, fmt::format("{} must be a number, not {}", key, kind_of(node)));
        return false;
    }
    const double found = *node.value<double>();
    if (!std::isfinite(found))
        error_at(node, fmt::format("{} must be a finite number, not {}", key, found));
    else if (!range.contains(found))
        error_at(node, fmt::format("{} {}, not {}", key, range.rule(), found));
    else
        return value = found, true;
    return false;
}

bool TableReader::read_numbers(std::string_view key, const toml::node& node, const Range& range,
                               std::span<double> values) {
    const toml::array* array = node.as_array();
    if (!array || array->size() != values.size()) {
        const std::string found = array ? fmt::format("{} of them", array->size()) : std::string(kind_of(node));
        error_at(node, fmt::format("{} must be a list of {} numbers, not {}", key, values.size(), found));
        return false;
    }
    std::vector<double> read(values.size());
    bool good = true;
    for (std::size_t i = 0; i < read.size(); ++i) good &= read_number(key, *array->get(i), range, read[i]);
    if (good) std::copy(read.begin(), read.end(), values.begin());
    return good;
}

double TableReader::number(std::string_view key, double fallback, const Range& range) {
    if (const toml::node* node = find(key)) read_number(key, *node, range, fallback);
    return fallback;
}

std::int64_t TableReader::integer(std::string_view key, std::int64_t fallback, std::int64_t lower, std::int64_t upper) {
    const toml::node* node = find(key);
    if (!node) return fallback;
    if (!node->is_integer()) {
        error(key, fmt::format("must be a whole number, not {}", kind_of(*node)));
        return fallback;
    }
    const std::int64_t value = **node->as_integer();
    if (value >= lower && value <= upper) return value;
    error(key, fmt::format("must lie between {} and {}, not {}", lower, upper, value));
    return fallback;
}

bool TableReader::boolean(std::string_view key, bool fallback) {
    const toml::node* node = find(key);
    if (!node) return fallback;
    if (const auto* value = node->as_boolean()) return **value;
    error(key, fmt::format("must be true or false, not {}", kind_of(*node)));
    return fallback;
}

std::string TableReader::text(std::string_view key, const std::string& fallback) {
    const toml::node* node = find(key);
    if (!node) return fallback;
    if (!node->is_string()) {
        error(key, fmt::format("must be text in quotes, not {}", kind_of(*node)));
        return fallback;
    }
    const std::string& value = **node->as_string();
    if (!value.empty()) return value;
    error(key, "must not be empty");
    return fallback;
}

std::size_t TableReader::word(std::string_view key, const std::vector<std::string>& names) {
    const std::string chosen = text(key);
    const std::size_t index = static_cast<std::size_t>(std::find(names.begin(), names.end(), chosen) - names.begin());
    if (!chosen.empty() && index == names.size()) {
        const std::string near = nearest_name(chosen, names);
        error(key, fmt::format("must be one of {}, not \"{}\"{}", fmt::join(names, ", "), chosen,
                               near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    }
    return index;
}

bool TableReader::numbers(std::string_view key, std::span<double> values, const Range& range) {
    const toml::node* node = find(key);
    return node && read_numbers(key, *node, range, values);
}

glm::dvec3 TableReader::vector(std::string_view key, const glm::dvec3& fallback) {
    glm::dvec3 value = fallback;
    numbers(key, std::span(&value.x, 3));
    return value;
}

glm::dvec3 TableReader::direction(std::string_view key, const glm::dvec3& fallback) {
    glm::dvec3 value = fallback;
    if (!numbers(key, std::span(&value.x, 3))) return fallback;
    if (value == glm::dvec3(0)) {
        error(key, "must not be zero");
        return fallback;
    }
    // By the largest component first, so that no square overflows or vanishes.
    value /= std::max({std::abs(value.x), std::abs(value.y), std::abs(value.z)});
    return glm::normalize(value);
}

glm::vec3 TableReader::color(std::string_view key, const glm::vec3& fallback) {
    const toml::node* node = find(key);
    if (!node) return fallback;
    glm::dvec3 value(fallback);
    if (node->is_array()) {
        read_numbers(key, *node, at_least(0), std::span(&value.x, 3));
    } else if (node->is_number()) {
        if (double grey = 0; read_number(key, *node, at_least(0), grey)) value = glm::dvec3(grey);
    } else {
        error(key, fmt::format("must be a colour: [r, g, b] or one number for grey, not {}", kind_of(*node)));
    }
    return glm::vec3(value);
}

template <class V>
bool TableReader::read_points(std::string_view key, std::vector<V>& values) {
    const toml::node* node = find(key);
    if (!node) return false;
    const toml::array* array = node->as_array();
    if (!array || array->empty()) {
        error(key, fmt::format("must be a list of points ({} numbers each)", V::length()));
        return false;
    }
    bool good = true;
    for (const toml::node& element : *array) {
        V value(0);
        good &= read_numbers(key, element, any_number(), std::span(&value.x, V::length()));
        values.push_back(value);
    }
    return good;
}

bool TableReader::points(std::string_view key, std::vector<glm::dvec3>& values) {
    return read_points(key, values);
}

bool TableReader::points(std::string_view key, std::vector<glm::dvec2>& values) {
    return read_points(key, values);
}

bool TableReader::faces(std::string_view key, std::vector<std::vector<std::uint32_t>>& values, std::size_t limit) {
    const toml::node* node = find(key);
    if (!node) return false;
    const toml::array* array = node->as_array();
    if (!array || array->empty()) {
        error(key, "must be a list of faces (three or more indices each)");
        return false;
    }
    const std::size_t errors_before = loading_.errors.size();
    for (const toml::node& element : *array) {
        const toml::array* face = element.as_array();
        if (!face || face->size() < 3) {
            error_at(element, fmt::format("a face in {} must be a list of three or more indices", key));
            continue;
        }
        values.emplace_back();
        for (const toml::node& index : *face) {
            const auto* value = index.as_integer();
            if (value && **value >= 0 && static_cast<std::uint64_t>(**value) < limit)
                values.back().push_back(static_cast<std::uint32_t>(**value));
            else
                error_at(index, fmt::format("an index in {} must be a whole number from 0 to {}", key, limit - 1));
        }
    }
    return loading_.errors.size() == errors_before;
}

const toml::table* TableReader::table(std::string_view key) {
    const toml::node* node = find(key);
    if (!node) return nullptr;
    if (!node->is_table()) error(key, fmt::format("must be a table, not {}", kind_of(*node)));
    return node->as_table();
}

void TableReader::finish() {
    if (any_key_) return;
    for (const auto& [key, node] : table_) {
        if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
        const std::string near = nearest_name(key.str(), known_);
        const std::string hint = near.empty() ? fmt::format("known here: {}", fmt::join(known_, ", "))
                                              : fmt::format("did you mean \"{}\"?", near);
        loading_.error(place(key.source()), fmt::format("{}: unknown key \"{}\"; {}", subject_, key.str(), hint));
    }
}

}  // namespace raymill
