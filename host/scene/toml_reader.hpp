// Reads the keys of one TOML table with their rules, and notes every fault with its place.
#pragma once

#include <toml++/toml.h>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/loading.hpp"

namespace raymill {

/// The numbers a key accepts. All must be finite, also as a 32-bit float.
struct Range {
    double lower = -std::numeric_limits<float>::max();
    double upper = std::numeric_limits<float>::max();
    bool open_lower = false;  // lower itself is refused, also by what rounds to it as a float
    bool open_upper = false;
    std::string rule() const;  // "must be above 0"
    bool contains(double value) const;
};

inline Range any_number() {
    return {};
}
inline Range at_least(double lower) {
    return {.lower = lower};
}
inline Range above(double lower) {
    return {.lower = lower, .open_lower = true};
}
inline Range between(double lower, double upper) {
    return {.lower = lower, .upper = upper};
}
inline Range inside(double lower, double upper) {
    return {.lower = lower, .upper = upper, .open_lower = true, .open_upper = true};
}

/// The name in `known` that is closest to `word`, if it is close enough to be what was meant; else empty.
/// By the optimal string alignment distance (Damerau 1964): up to a third of the letters, at least one.
std::string nearest_name(std::string_view word, const std::vector<std::string>& known);

/// One table. Each reader returns `fallback` where the key is missing or faulty; after the last, finish() refuses the
/// keys that none has asked for. Messages begin with the subject ("light 2") and the key.
class TableReader {
  public:
    TableReader(Loading& loading, std::string file, const toml::table& table, std::string subject);

    bool has(std::string_view key);
    bool is_number(std::string_view key) {
        const toml::node* node = find(key);
        return node && node->is_number();
    }
    /// Notes an error for each of these keys that is missing; returns whether all are there.
    bool require(std::initializer_list<std::string_view> keys);

    double number(std::string_view key, double fallback, const Range& range);
    float real(std::string_view key, float fallback, const Range& range) {
        return static_cast<float>(number(key, fallback, range));
    }
    std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t lower, std::int64_t upper);
    bool boolean(std::string_view key, bool fallback);
    std::string text(std::string_view key, const std::string& fallback = {});
    /// Exactly values.size() numbers; false (and values untouched) if missing or faulty.
    bool numbers(std::string_view key, std::span<double> values, const Range& range = any_number());
    glm::dvec3 vector(std::string_view key, const glm::dvec3& fallback);
    /// A vector that is not zero, made unit.
    glm::dvec3 direction(std::string_view key, const glm::dvec3& fallback);
    /// Three numbers or one for grey, none negative.
    glm::vec3 color(std::string_view key, const glm::vec3& fallback);
    /// A list of lists of 3 (or 2) numbers; false if missing or faulty.
    bool points(std::string_view key, std::vector<glm::dvec3>& values);
    bool points(std::string_view key, std::vector<glm::dvec2>& values);
    /// A list of lists of at least three indices below `limit`.
    bool faces(std::string_view key, std::vector<std::vector<std::uint32_t>>& values, std::size_t limit);
    const toml::table* table(std::string_view key);

    template <class E>
    E choice(std::string_view key, E fallback, std::initializer_list<std::pair<std::string_view, E>> words) {
        std::vector<std::string> names;
        for (const auto& [word, value] : words) names.emplace_back(word);
        const std::size_t chosen = word(key, names);
        return chosen < words.size() ? (words.begin() + chosen)->second : fallback;
    }

    /// Notes "subject: key message" at the key's value, or at the table if the key is missing.
    void error(std::string_view key, const std::string& message);
    void error_at(const toml::node& node, const std::string& message);
    SourcePosition position_of(std::string_view key) const;
    SourcePosition position() const { return place(table_.source()); }
    const std::string& file() const { return file_; }
    const std::string& subject() const { return subject_; }
    Loading& loading() { return loading_; }

    /// Makes finish() accept any key: where a faulty key leaves open which ones belong.
    void ignore_other_keys() { any_key_ = true; }
    void finish();

  private:
    const toml::node* find(std::string_view key);
    std::size_t word(std::string_view key, const std::vector<std::string>& names);
    bool read_number(std::string_view key, const toml::node& node, const Range& range, double& value);
    bool read_numbers(std::string_view key, const toml::node& node, const Range& range, std::span<double> values);
    template <class V>
    bool read_points(std::string_view key, std::vector<V>& values);
    SourcePosition place(const toml::source_region& region) const;

    Loading& loading_;
    std::string file_;
    const toml::table& table_;
    std::string subject_;
    std::vector<std::string> known_;
    bool any_key_ = false;
};

}  // namespace raymill
