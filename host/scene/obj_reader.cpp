#include "scene/obj_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <string_view>

#include "scene/number_text.hpp"

namespace raymill {
namespace {

constexpr std::size_t most_errors = 20;
constexpr std::size_t most_corners = 10000;  // of a polygon: ear clipping takes quadratic time

/// Cuts `text` at the first of its characters that stops it; the head is returned. Large files have a hundred million
/// characters: a search for a set of them by the standard library takes half of the time to read one.
template <typename Stops>
std::string_view take_until(std::string_view& text, Stops stops) {
    const auto end = static_cast<std::size_t>(std::ranges::find_if(text, stops) - text.begin());
    const std::string_view head = text.substr(0, end);
    text.remove_prefix(end);
    return head;
}

constexpr auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
constexpr auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
constexpr auto is_slash = [](char c) { return c == '/'; };

std::string_view trimmed(std::string_view text) {
    take_until(text, std::not_fn(is_blank));
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// The next word of the line, empty at its end or where a comment begins.
std::string_view next_word(std::string_view& line) {
    take_until(line, std::not_fn(is_blank));
    if (line.starts_with('#')) line = {};
    return take_until(line, is_blank);
}

class Reader {
  public:
    Reader(const std::string& text, const std::string& file) : text_(text), file_name_(file) {
        // About what files of triangles have: to grow would touch, and copy, as much again.
        corners_.reserve(text.size() / 20);
        polygons_.reserve(text.size() / 60);
    }

    ObjFile read() {
        while (!text_.empty() && file_.errors.size() < most_errors) read_line();
        if (file_.errors.empty()) check_and_triangulate();
        if (skipped_lines_ > 0)
            warn(0, fmt::format("{} lines, points or other elements that are not faces are left out", skipped_lines_));
        if (skipped_faces_ > 0)
            warn(first_skipped_face_,
                 fmt::format("{} faces with fewer than three corners are left out", skipped_faces_));
        return std::move(file_);
    }

  private:
    struct Polygon {
        std::uint32_t first;  // into corners_
        std::uint32_t count;
        std::uint32_t material, object, group;
        int line;
    };

    void error(int line, std::string message) { file_.errors.push_back({{file_name_, line, 0}, std::move(message)}); }
    void warn(int line, std::string message) { file_.warnings.push_back({{file_name_, line, 0}, std::move(message)}); }

    std::string_view take_line() {
        ++line_;
        const std::string_view line = take_until(text_, ends_line);
        if (text_.starts_with("\r\n"))
            text_.remove_prefix(2);
        else if (!text_.empty())
            text_.remove_prefix(1);
        return line;
    }

    void read_line() {
        std::string_view line = take_line();
        first_line_ = line_;
        std::string joined;
        while (line.ends_with('\\') && !text_.empty()) {
            std::string longer(line.substr(0, line.size() - 1));
            longer += ' ';
            longer += take_line();
            joined = std::move(longer);
            line = joined;
        }
        const std::string_view keyword = next_word(line);
        if (keyword == "v")
            read_vector(line, file_.mesh.positions, 3);
        else if (keyword == "vn")
            read_vector(line, file_.mesh.normals, 3);
        else if (keyword == "vt")
            read_uv(line);
        else if (keyword == "f" || keyword == "fo")
            read_face(line);
        else if (keyword == "o" || keyword == "g")
            object_name_ = trimmed(line), object_ = NO_INDEX;
        else if (keyword == "s")
            read_group(line);
        else if (keyword == "usemtl")
            material_ = use_material(std::string(trimmed(line)));
        else if (keyword == "mtllib")
            file_.libraries.push_back({std::string(trimmed(line)), first_line_});
        else if (keyword == "l" || keyword == "p" || keyword == "curv" || keyword == "surf")
            ++skipped_lines_;
    }

    /// Up to `count` numbers; returns how many there were before the line's end or a fault.
    int read_numbers(std::string_view& line, double* values, int count) {
        for (int i = 0; i < count; ++i) {
            const std::string_view word = next_word(line);
            if (word.empty()) return i;
            if (!parse_number(word, values[i])) {
                error(first_line_, fmt::format("\"{}\" is not a number", word.substr(0, 40)));
                return -1;
            }
        }
        return count;
    }

    void read_vector(std::string_view line, std::vector<glm::dvec3>& values, int needed) {
        glm::dvec3 value(0);
        const int found = read_numbers(line, &value.x, 3);
        if (found >= 0 && found < needed)
            error(first_line_, fmt::format("three coordinates are needed, not {}", found));
        values.push_back(value);
    }

    void read_uv(std::string_view line) {
        double uv[2] = {0, 0};
        if (read_numbers(line, uv, 2) == 0) error(first_line_, "a texture coordinate is needed");
        file_.mesh.uvs.emplace_back(uv[0], uv[1]);
    }

    void read_group(std::string_view line) {
        const std::string_view word = next_word(line);
        group_ = 0;  // "off" and anything that is no number
        std::from_chars(word.data(), word.data() + word.size(), group_);
    }

    std::uint32_t use_material(const std::string& name) {
        const auto next = static_cast<std::uint32_t>(file_.material_names.size());
        const auto [entry, is_new] = materials_.try_emplace(name, next);
        if (is_new) {
            file_.material_names.push_back(name);
            file_.material_lines.push_back(first_line_);
        }
        return entry->second;
    }

    std::uint32_t current_object() {
        if (object_ != NO_INDEX) return object_;
        const auto next = static_cast<std::uint32_t>(file_.object_names.size());
        const auto [entry, is_new] = objects_.try_emplace(object_name_, next);
        if (is_new) file_.object_names.push_back(object_name_);
        return object_ = entry->second;
    }

    /// One index of a corner: counts from 1, or back from the newest value. NO_INDEX and an error for a bad one.
    std::uint32_t resolve(std::string_view digits, std::size_t known, const char* what) {
        std::int64_t index = 0;
        const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
        const bool whole = fault == std::errc() && end == digits.data() + digits.size();
        const std::int64_t from_zero = index > 0 ? index - 1 : static_cast<std::int64_t>(known) + index;
        if (!whole)
            error(first_line_, fmt::format("\"{}\" is not the index of a {}", digits.substr(0, 40), what));
        else if (index == 0)
            error(first_line_, fmt::format("the index of a {} is 0, but indices count from 1", what));
        else if (from_zero < 0 || from_zero >= NO_INDEX)
            error(first_line_, fmt::format("the face refers to {} {}, but there are {} so far", what, index, known));
        else
            return static_cast<std::uint32_t>(from_zero);
        return NO_INDEX;
    }

    Corner read_corner(std::string_view word) {
        Corner corner;
        corner.position = resolve(take_until(word, is_slash), file_.mesh.positions.size(), "vertex");
        if (word.empty()) return corner;
        word.remove_prefix(1);
        const std::string_view uv = take_until(word, is_slash);
        if (!uv.empty()) corner.uv = resolve(uv, file_.mesh.uvs.size(), "texture coordinate");
        if (word.empty()) return corner;
        word.remove_prefix(1);
        if (!word.empty()) corner.normal = resolve(word, file_.mesh.normals.size(), "normal");
        return corner;
    }

    void read_face(std::string_view line) {
        const std::size_t first = corners_.size();
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
            const std::size_t errors_before = file_.errors.size();
            corners_.push_back(read_corner(word));
            if (file_.errors.size() > errors_before) return;
        }
        const std::size_t count = corners_.size() - first;
        if (count > most_corners)
            return error(first_line_, fmt::format("a face of {} corners: at most {} are read", count, most_corners));
        if (count < 3) {
            if (skipped_faces_++ == 0) first_skipped_face_ = first_line_;
            corners_.resize(first);
            return;
        }
        if (corners_.size() >= NO_INDEX) return error(first_line_, "the file has more faces than can be counted");
        polygons_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), material_,
                             current_object(), group_, first_line_});
    }

    bool refers_to_nothing(const Polygon& polygon, std::uint32_t index, std::size_t known, const char* what) {
        if (index == NO_INDEX || index < known) return false;
        error(polygon.line, fmt::format("the face refers to {} {}, but the file has {}", what, index + 1, known));
        return true;
    }

    bool is_sound(const Polygon& polygon) {
        const IndexedMesh& mesh = file_.mesh;
        for (std::uint32_t i = polygon.first; i < polygon.first + polygon.count; ++i)
            if (refers_to_nothing(polygon, corners_[i].position, mesh.positions.size(), "vertex") ||
                refers_to_nothing(polygon, corners_[i].uv, mesh.uvs.size(), "texture coordinate") ||
                refers_to_nothing(polygon, corners_[i].normal, mesh.normals.size(), "normal"))
                return false;
        return true;
    }

    /// Some exporters write normal or uv indices without any normals or uvs: then they are left out.
    void drop_empty_attributes() {
        const bool no_normals = file_.mesh.normals.empty(), no_uvs = file_.mesh.uvs.empty();
        std::size_t dropped = 0;
        for (Corner& corner : corners_) {
            if (no_normals && corner.normal != NO_INDEX) corner.normal = NO_INDEX, ++dropped;
            if (no_uvs && corner.uv != NO_INDEX) corner.uv = NO_INDEX, ++dropped;
        }
        if (dropped > 0)
            warn(0, "faces refer to normals or texture coordinates, but the file has none: these indices are left out");
    }

    void check_and_triangulate() {
        drop_empty_attributes();
        IndexedMesh& mesh = file_.mesh;
        const std::size_t triangles = corners_.size() - 2 * polygons_.size();
        mesh.triangles.reserve(triangles);
        mesh.smoothing_groups.reserve(triangles);
        mesh.materials.reserve(triangles);
        mesh.objects.reserve(triangles);
        std::vector<glm::dvec3> points;
        std::vector<std::array<std::uint32_t, 3>> pieces;
        for (const Polygon& polygon : polygons_) {
            if (file_.errors.size() >= most_errors) return;
            if (!is_sound(polygon)) continue;
            const Corner* corner = &corners_[polygon.first];
            points.clear();
            pieces.clear();
            for (std::uint32_t i = 0; i < polygon.count; ++i) points.push_back(mesh.positions[corner[i].position]);
            triangulate(points, pieces);
            for (const auto& [a, b, c] : pieces) mesh.triangles.push_back({corner[a], corner[b], corner[c]});
            mesh.smoothing_groups.resize(mesh.triangles.size(), polygon.group);
            mesh.materials.resize(mesh.triangles.size(), polygon.material);
            mesh.objects.resize(mesh.triangles.size(), polygon.object);
        }
    }

    std::string_view text_;
    const std::string& file_name_;
    ObjFile file_;
    std::vector<Corner> corners_;
    std::vector<Polygon> polygons_;
    std::map<std::string, std::uint32_t> materials_, objects_;
    std::string object_name_;
    std::uint32_t material_ = NO_INDEX, object_ = NO_INDEX, group_ = 0;
    int line_ = 0, first_line_ = 0;
    int skipped_lines_ = 0, skipped_faces_ = 0, first_skipped_face_ = 0;
};

}  // namespace

ObjFile read_obj(const std::string& text, const std::string& file) {
    return Reader(text, file).read();
}

}  // namespace raymill
