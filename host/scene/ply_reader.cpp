#include "scene/ply_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/color.hpp"
#include "scene/ply_numbers.hpp"

namespace raymill {
namespace {

constexpr std::size_t most_corners = 10000;  // of a polygon: ear clipping takes quadratic time

/// What a scalar property of a vertex or face is for; `none` is skipped.
enum class Role { x, y, z, nx, ny, nz, u, v, red, green, blue, none };

Role role_of(const std::string& name) {
    static const std::pair<const char*, Role> roles[] = {{"x", Role::x},
                                                         {"y", Role::y},
                                                         {"z", Role::z},
                                                         {"nx", Role::nx},
                                                         {"ny", Role::ny},
                                                         {"nz", Role::nz},
                                                         {"u", Role::u},
                                                         {"v", Role::v},
                                                         {"s", Role::u},
                                                         {"t", Role::v},
                                                         {"texture_u", Role::u},
                                                         {"texture_v", Role::v},
                                                         {"texture_s", Role::u},
                                                         {"texture_t", Role::v},
                                                         {"red", Role::red},
                                                         {"green", Role::green},
                                                         {"blue", Role::blue},
                                                         {"diffuse_red", Role::red},
                                                         {"diffuse_green", Role::green},
                                                         {"diffuse_blue", Role::blue}};
    for (const auto& [known, role] : roles)
        if (name == known) return role;
    return Role::none;
}

bool has_roles(const PlyElement& element, Role first, int count) {
    for (int i = 0; i < count; ++i) {
        const Role role = static_cast<Role>(static_cast<int>(first) + i);
        if (std::none_of(element.properties.begin(), element.properties.end(),
                         [&](const PlyProperty& p) { return !p.is_list && role_of(p.name) == role; }))
            return false;
    }
    return true;
}

bool is_index_list(const PlyProperty& property) {
    return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// A colour's component of this type in linear light.
float linear_component(double value, PlyType type) {
    switch (type) {
        case PlyType::float32:
        case PlyType::float64:
            return static_cast<float>(std::max(value, 0.0));
        case PlyType::uint8:
        case PlyType::int8:
            return static_cast<float>(srgb_to_linear(std::clamp(value / 255, 0.0, 1.0)));
        default:
            return static_cast<float>(srgb_to_linear(std::clamp(value / 65535, 0.0, 1.0)));
    }
}

class Reader {
  public:
    Reader(const std::string& bytes, const std::string& file)
        : file_name_(file), header_(read_ply_header(bytes, file)), numbers_(bytes, header_, file) {}

    PlyFile read() {
        const auto vertex = std::find_if(header_.elements.begin(), header_.elements.end(),
                                         [](const PlyElement& e) { return e.name == "vertex"; });
        if (vertex == header_.elements.end()) throw SceneError({file_name_}, "there is no element \"vertex\"");
        if (!has_roles(*vertex, Role::x, 3))
            throw SceneError({file_name_, vertex->line, 0}, "the vertices have no properties x, y and z");
        if (vertex->count >= NO_INDEX)
            throw SceneError({file_name_, vertex->line, 0}, fmt::format("{} vertices are too many", vertex->count));
        vertices_ = vertex->count;
        for (const PlyElement& element : header_.elements) read_element(element);
        numbers_.expect_end();
        add_polygons();
        if (skipped_faces_ > 0) {
            Diagnostic& warning = result_.warnings.emplace_back();
            warning.position.file = file_name_;
            warning.message = fmt::format("{} faces with fewer than three corners are left out", skipped_faces_);
        }
        result_.textures = std::move(header_.textures);
        return std::move(result_);
    }

  private:
    struct Polygon {
        std::uint32_t count;
        std::uint32_t color;  // of the face, or NO_INDEX
    };

    /// The numbers of one element that have a role; a property that comes twice keeps its first value.
    struct Values {
        double number[static_cast<int>(Role::none)] = {};
        PlyType color_type = PlyType::uint8;
        double operator[](Role role) const { return number[static_cast<int>(role)]; }
    };

    void read_element(const PlyElement& element) {
        std::size_t least = 0;
        for (const PlyProperty& property : element.properties)
            least += numbers_.least_bytes(property.is_list ? property.count_type : property.type);
        if (least == 0) return;
        if (element.count > numbers_.bytes_left() / least)
            throw SceneError({file_name_, element.line, 0},
                             fmt::format("there are to be {} elements \"{}\", but the file ends after {} more bytes",
                                         element.count, element.name, numbers_.bytes_left()));
        if (element.name == "vertex") return read_vertices(element);
        const bool is_face = element.name == "face", is_strip = element.name == "tristrips";
        std::vector<Role> roles = roles_of(element);
        const bool colored = is_face && has_roles(element, Role::red, 3);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            Values values;
            indices_.clear();
            face_uvs_.clear();
            for (std::size_t p = 0; p < element.properties.size(); ++p)
                read_property(element.properties[p], roles[p], values);
            if (is_face) keep_face(colored ? add_color(values, face_colors_) : NO_INDEX);
            if (is_strip) keep_strips();
        }
    }

    static std::vector<Role> roles_of(const PlyElement& element) {
        std::vector<Role> roles;
        for (const PlyProperty& property : element.properties) {
            const Role role = property.is_list ? Role::none : role_of(property.name);
            const bool again = std::find(roles.begin(), roles.end(), role) != roles.end();
            roles.push_back(again ? Role::none : role);
        }
        return roles;
    }

    void read_property(const PlyProperty& property, Role role, Values& values) {
        if (property.is_list) return read_list(property);
        const double value = numbers_.next(property.type);
        if (role == Role::none) return;
        const bool is_normal = role == Role::nx || role == Role::ny || role == Role::nz;
        if (!is_normal && !std::isfinite(static_cast<float>(value)))
            numbers_.fail(fmt::format("the property \"{}\" must be a finite number", property.name));
        values.number[static_cast<int>(role)] = value;
        if (role == Role::red) values.color_type = property.type;
    }

    void read_list(const PlyProperty& property) {
        const double count = numbers_.next(property.count_type);
        if (!(count >= 0 && count == std::floor(count)))
            numbers_.fail(fmt::format("the list \"{}\" has the length {}", property.name, count));
        if (count > static_cast<double>(numbers_.bytes_left() / numbers_.least_bytes(property.type)))
            numbers_.fail(fmt::format("the list \"{}\" has the length {}, but the file ends after {} more bytes",
                                      property.name, count, numbers_.bytes_left()));
        std::vector<double>* kept = is_index_list(property)       ? &indices_
                                    : property.name == "texcoord" ? &face_uvs_
                                                                  : nullptr;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            const double value = numbers_.next(property.type);
            if (kept) kept->push_back(value);
        }
    }

    std::uint32_t add_color(const Values& values, std::vector<glm::vec3>& colors) {
        const auto component = [&](Role role) { return linear_component(values[role], values.color_type); };
        colors.push_back({component(Role::red), component(Role::green), component(Role::blue)});
        return static_cast<std::uint32_t>(colors.size() - 1);
    }

    void read_vertices(const PlyElement& element) {
        ColoredMesh& mesh = result_.mesh;
        has_normals_ = has_roles(element, Role::nx, 3);
        has_uvs_ = has_roles(element, Role::u, 2);
        has_colors_ = has_roles(element, Role::red, 3);
        const std::vector<Role> roles = roles_of(element);
        mesh.positions.reserve(vertices_);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            Values values;
            for (std::size_t p = 0; p < element.properties.size(); ++p)
                read_property(element.properties[p], roles[p], values);
            mesh.positions.emplace_back(values[Role::x], values[Role::y], values[Role::z]);
            if (has_normals_) mesh.normals.emplace_back(values[Role::nx], values[Role::ny], values[Role::nz]);
            if (has_uvs_) mesh.uvs.emplace_back(values[Role::u], values[Role::v]);
            if (has_colors_) add_color(values, mesh.colors);
        }
    }

    std::uint32_t checked_index(double value) {
        if (!(value >= 0 && value < static_cast<double>(vertices_) && value == std::floor(value)))
            numbers_.fail(
                fmt::format("a face refers to vertex {}, but there are {}, counted from 0", value, vertices_));
        return static_cast<std::uint32_t>(value);
    }

    void keep_corner(double index) {
        if (corners_.size() >= NO_INDEX - 1) numbers_.fail("the file has more faces than can be counted");
        corners_.push_back(checked_index(index));
    }

    void keep_face(std::uint32_t color) {
        if (indices_.size() > most_corners)
            numbers_.fail(fmt::format("a face of {} corners: at most {} are read", indices_.size(), most_corners));
        if (indices_.size() < 3) {
            ++skipped_faces_;
            return;
        }
        const bool has_own_uvs = face_uvs_.size() == 2 * indices_.size();
        for (std::size_t i = 0; i < indices_.size(); ++i) {
            keep_corner(indices_[i]);
            if (!has_own_uvs) continue;
            const glm::dvec2 uv(face_uvs_[2 * i], face_uvs_[2 * i + 1]);
            if (!std::isfinite(static_cast<float>(uv.x) + static_cast<float>(uv.y)))
                numbers_.fail("the property \"texcoord\" must be finite numbers");
            wedge_uvs_.resize(corners_.size() - 1, {0, 0});
            wedge_uvs_.push_back(uv);
        }
        polygons_.push_back({static_cast<std::uint32_t>(indices_.size()), color});
    }

    /// Every second triangle of a strip turns the other way; one that repeats a corner only joins its neighbours.
    void keep_strips() {
        std::size_t first = 0;
        for (std::size_t i = 0; i < indices_.size(); ++i) {
            if (indices_[i] == -1) first = i + 1;
            if (indices_[i] == -1 || i < first + 2) continue;
            const bool odd = (i - first) % 2 == 1;
            const double a = indices_[i - 2], b = indices_[i - 1], c = indices_[i];
            if (a == b || b == c || c == a) continue;
            for (const double index : {odd ? b : a, odd ? a : b, c}) keep_corner(index);
            polygons_.push_back({3, NO_INDEX});
        }
    }

    Corner corner(std::size_t i) const {
        const std::uint32_t index = corners_[i];
        const std::uint32_t uv = has_wedge_uvs_ ? static_cast<std::uint32_t>(i) : has_uvs_ ? index : NO_INDEX;
        return {index, has_normals_ ? index : NO_INDEX, uv};
    }

    /// Whether the normals of all three vertices point to where the triangle is clockwise. PLY does not say on which
    /// side a face's outside is, and programs differ: so the normals decide.
    bool normals_oppose(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        if (!has_normals_) return false;
        const std::vector<glm::dvec3>& p = result_.mesh.positions;
        const glm::dvec3 face = glm::cross(p[b] - p[a], p[c] - p[a]);
        bool oppose = true;
        for (const std::uint32_t i : {a, b, c}) oppose &= glm::dot(face, result_.mesh.normals[i]) < 0;
        return oppose;
    }

    void add_polygons() {
        ColoredMesh& mesh = result_.mesh;
        if (!wedge_uvs_.empty()) {
            wedge_uvs_.resize(corners_.size(), {0, 0});
            mesh.uvs = std::move(wedge_uvs_);
            has_wedge_uvs_ = true;
        }
        const bool face_colors = !has_colors_ && !face_colors_.empty();
        if (face_colors) mesh.colors = std::move(face_colors_), mesh.colors.emplace_back(1);
        const auto white = static_cast<std::uint32_t>(mesh.colors.size() - 1);
        mesh.triangles.reserve(corners_.size() - 2 * polygons_.size());
        std::vector<glm::dvec3> points;
        std::vector<std::array<std::uint32_t, 3>> pieces;
        std::size_t first = 0;
        for (const auto& [count, color] : polygons_) {
            points.clear();
            pieces.clear();
            for (std::size_t i = first; i < first + count; ++i) points.push_back(mesh.positions[corners_[i]]);
            triangulate(points, pieces);
            for (auto [a, b, c] : pieces) {
                if (normals_oppose(corners_[first + a], corners_[first + b], corners_[first + c])) std::swap(b, c);
                mesh.triangles.push_back({corner(first + a), corner(first + b), corner(first + c)});
                if (has_colors_)
                    mesh.corner_colors.push_back({corners_[first + a], corners_[first + b], corners_[first + c]});
                const std::uint32_t of_face = color == NO_INDEX ? white : color;
                if (face_colors) mesh.corner_colors.push_back({of_face, of_face, of_face});
            }
            first += count;
        }
    }

    const std::string& file_name_;
    PlyHeader header_;
    PlyNumbers numbers_;
    PlyFile result_;
    std::uint64_t vertices_ = 0;
    bool has_normals_ = false, has_uvs_ = false, has_colors_ = false, has_wedge_uvs_ = false;
    std::vector<double> indices_, face_uvs_;  // lists of the element being read
    std::vector<std::uint32_t> corners_;      // vertices of all polygons, one after the other
    std::vector<glm::dvec2> wedge_uvs_;       // one a corner, or empty
    std::vector<glm::vec3> face_colors_;
    std::vector<Polygon> polygons_;
    std::size_t skipped_faces_ = 0;
};

}  // namespace

PlyFile read_ply(const std::string& bytes, const std::string& file) {
    return Reader(bytes, file).read();
}

}  // namespace raymill
