#include <fmt/format.h>

#include <cmath>

#include "scene/mesh_file.hpp"
#include "scene/shapes.hpp"
#include "scene/toml_reader.hpp"
#include "scene/toml_scene.hpp"

namespace raymill {
namespace {

/// What every shape has: its name, material and transform.
struct Placement {
    std::string name;
    std::string shape;
    std::optional<std::uint32_t> material;
    Transform transform;
};

glm::dvec3 read_scale(TableReader& reader) {
    glm::dvec3 scale(1);
    if (!reader.has("scale")) return scale;
    if (reader.is_number("scale"))
        scale = glm::dvec3(reader.number("scale", 1, any_number()));
    else
        scale = reader.vector("scale", scale);
    if (scale.x * scale.y * scale.z == 0) {
        reader.error("scale", "must not be zero on any axis");
        return glm::dvec3(1);
    }
    return scale;
}

glm::dmat4 read_matrix(TableReader& reader) {
    double rows[16];
    if (!reader.numbers("matrix", rows)) return glm::dmat4(1);
    glm::dmat4 matrix;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) matrix[column][row] = rows[4 * row + column];
    const bool affine = rows[12] == 0 && rows[13] == 0 && rows[14] == 0 && rows[15] == 1;
    const double determinant = glm::determinant(glm::dmat3(matrix));
    if (!affine)
        reader.error("matrix", "must end with the row 0, 0, 0, 1");
    else if (determinant == 0 || !std::isfinite(1 / determinant))
        reader.error("matrix", "must be invertible");
    else
        return matrix;
    return glm::dmat4(1);
}

Placement read_placement(TableReader& reader, const MaterialNames& materials) {
    Placement placement;
    placement.name = reader.text("name");
    const glm::dvec3 scale = read_scale(reader);
    const glm::dvec3 rotate = reader.vector("rotate", glm::dvec3(0));
    const glm::dvec3 translate = reader.vector("translate", glm::dvec3(0));
    placement.transform = Transform(compose_transform(scale, rotate, translate, read_matrix(reader)));
    const std::string name = reader.text("material");
    if (name.empty()) return placement;
    if (const auto found = materials.find(name); found != materials.end()) {
        placement.material = found->second;
        return placement;
    }
    std::vector<std::string> names;
    for (const auto& [known, index] : materials) names.push_back(known);
    const std::string near = nearest_name(name, names);
    reader.error("material", fmt::format("\"{}\" is not the name of a material{}", name,
                                         near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    return placement;
}

std::uint32_t new_object(Scene& scene, const Placement& placement, double chord_error) {
    scene.objects.push_back({placement.name.empty() ? placement.shape : placement.name, placement.shape, chord_error});
    return static_cast<std::uint32_t>(scene.objects.size() - 1);
}

void add_mesh(TableReader& reader, const Placement& placement, const IndexedMesh& mesh) {
    Scene& scene = reader.loading().scene;
    const double chord_error = mesh.chord_error * placement.transform.largest_stretch();
    const std::uint32_t object = new_object(scene, placement, chord_error);
    append_mesh(scene, mesh, placement.transform, placement.material.value_or(0), object);
}

void read_sphere(TableReader& reader, const Placement& placement) {
    if (!reader.require({"center", "radius"})) return;
    const glm::dvec3 center = reader.vector("center", glm::dvec3(0));
    const double radius = reader.number("radius", 1, above(0));
    const std::optional<double> scale = placement.transform.uniform_scale();
    if (!scale) return add_mesh(reader, placement, sphere_mesh(center, radius));
    const glm::vec3 c(placement.transform.point(center));
    const auto r = static_cast<float>(radius * *scale);
    if (!(std::isfinite(c.x + c.y + c.z) && std::isfinite(r) && r > 0))
        return reader.error("radius", "and center leave the range of 32-bit floats after the transform");
    Scene& scene = reader.loading().scene;
    const std::uint32_t object = new_object(scene, placement, 0);
    scene.spheres.push_back({{c.x, c.y, c.z}, r, placement.material.value_or(0), object});
}

void read_plane(TableReader& reader, const Placement& placement) {
    if (!reader.require({"point", "normal"})) return;
    const glm::vec3 point(placement.transform.point(reader.vector("point", glm::dvec3(0))));
    const glm::vec3 normal(placement.transform.normal(reader.direction("normal", glm::dvec3(0, 1, 0))));
    if (!std::isfinite(point.x + point.y + point.z))
        return reader.error("point", "leaves the range of 32-bit floats after the transform");
    Scene& scene = reader.loading().scene;
    const std::uint32_t object = new_object(scene, placement, 0);
    scene.planes.push_back(
        {{point.x, point.y, point.z}, {normal.x, normal.y, normal.z}, placement.material.value_or(0), object});
}

void read_disk(TableReader& reader, const Placement& placement) {
    if (!reader.require({"center", "normal", "radius"})) return;
    const glm::dvec3 center = reader.vector("center", glm::dvec3(0));
    const glm::dvec3 normal = reader.direction("normal", glm::dvec3(0, 1, 0));
    add_mesh(reader, placement, disk_mesh(center, normal, reader.number("radius", 1, above(0))));
}

void read_rectangle(TableReader& reader, const Placement& placement) {
    if (!reader.require({"center", "edge_u", "edge_v"})) return;
    const glm::dvec3 center = reader.vector("center", glm::dvec3(0));
    const glm::dvec3 u = reader.vector("edge_u", glm::dvec3(1, 0, 0)), v = reader.vector("edge_v", glm::dvec3(0, 1, 0));
    if (!(glm::length(glm::cross(u, v)) > 1e-9 * glm::length(u) * glm::length(v)))
        return reader.error("edge_u", "and edge_v must span an area: they are zero or parallel");
    add_mesh(reader, placement, rectangle_mesh(center, u, v));
}

void read_box(TableReader& reader, const Placement& placement) {
    if (!reader.require({"min", "max"})) return;
    const glm::dvec3 lower = reader.vector("min", glm::dvec3(0)), upper = reader.vector("max", glm::dvec3(1));
    if (!(lower.x < upper.x && lower.y < upper.y && lower.z < upper.z))
        return reader.error("max", "must be above min on each axis");
    add_mesh(reader, placement, box_mesh(lower, upper));
}

/// Cylinder and cone.
void read_round(TableReader& reader, const Placement& placement) {
    if (!reader.require({"base", "top", "radius"})) return;
    const glm::dvec3 base = reader.vector("base", glm::dvec3(0)), top = reader.vector("top", glm::dvec3(0, 1, 0));
    const double radius = reader.number("radius", 1, above(0));
    if (base == top) return reader.error("top", "must differ from base");
    add_mesh(reader, placement,
             placement.shape == "cone" ? cone_mesh(base, top, radius) : cylinder_mesh(base, top, radius));
}

void read_lathe(TableReader& reader, const Placement& placement) {
    std::vector<glm::dvec2> profile;
    const bool good = reader.require({"profile"}) && reader.points("profile", profile);
    LatheShape shape;
    shape.center = reader.vector("center", shape.center);
    shape.segments = static_cast<std::uint32_t>(reader.integer("segments", shape.segments, 3, 4096));
    shape.smooth_angle = reader.number("smooth_angle", shape.smooth_angle, between(0, 180));
    if (!good) return;
    if (profile.size() < 2) return reader.error("profile", "must have at least two points");
    bool touches_axis_only = true;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (profile[i].x < 0) return reader.error("profile", fmt::format("has a negative radius in point {}", i + 1));
        if (i > 0 && profile[i] == profile[i - 1])
            return reader.error("profile", fmt::format("has points {} and {} at the same place", i, i + 1));
        touches_axis_only &= profile[i].x == 0;
    }
    if (touches_axis_only) return reader.error("profile", "must leave the axis: all its radii are 0");
    shape.profile = profile;
    add_mesh(reader, placement, lathe_mesh(shape));
}

/// One for each position, or none.
template <class V>
bool read_attribute(TableReader& reader, std::string_view key, std::vector<V>& values, std::size_t count) {
    if (!reader.has(key)) return true;
    if (!reader.points(key, values)) return false;
    if (values.size() == count) return true;
    reader.error(key, fmt::format("must have one entry a vertex, {}, not {}", count, values.size()));
    return false;
}

Corner inline_corner(const IndexedMesh& mesh, std::uint32_t index) {
    return {index, mesh.normals.empty() ? NO_INDEX : index, mesh.uvs.empty() ? NO_INDEX : index};
}

/// vertices, normals and uvs.
bool read_vertices(TableReader& reader, IndexedMesh& mesh) {
    const bool good = reader.points("vertices", mesh.positions);
    reader.has("normals"), reader.has("uvs");  // known also where the vertices are faulty
    if (!good) return false;
    const bool normals = read_attribute(reader, "normals", mesh.normals, mesh.positions.size());
    return read_attribute(reader, "uvs", mesh.uvs, mesh.positions.size()) && normals;
}

void read_triangle(TableReader& reader, const Placement& placement) {
    IndexedMesh mesh;
    const bool complete = reader.require({"vertices"});
    if (!read_vertices(reader, mesh) || !complete) return;
    if (mesh.positions.size() != 3)
        return reader.error("vertices", fmt::format("must be 3 points, not {}", mesh.positions.size()));
    mesh.triangles.push_back({inline_corner(mesh, 0), inline_corner(mesh, 1), inline_corner(mesh, 2)});
    add_mesh(reader, placement, mesh);
}

void read_inline_mesh(TableReader& reader, const Placement& placement, const std::optional<double>& smooth_angle) {
    const bool complete = reader.require({"vertices", "faces"});
    IndexedMesh mesh;
    std::vector<std::vector<std::uint32_t>> faces;
    const bool good = read_vertices(reader, mesh);
    if (!complete || !reader.faces("faces", faces, mesh.positions.size()) || !good) return;
    std::vector<glm::dvec3> points;
    std::vector<std::array<std::uint32_t, 3>> pieces;
    for (const auto& face : faces) {
        points.clear();
        pieces.clear();
        for (const std::uint32_t index : face) points.push_back(mesh.positions[index]);
        triangulate(points, pieces);
        for (const auto& [a, b, c] : pieces)
            mesh.triangles.push_back(
                {inline_corner(mesh, face[a]), inline_corner(mesh, face[b]), inline_corner(mesh, face[c])});
    }
    if (smooth_angle) smooth_by_angle(mesh, *smooth_angle);
    add_mesh(reader, placement, mesh);
}

void read_mesh(TableReader& reader, const Placement& placement) {
    std::optional<double> smooth_angle;
    if (reader.has("smooth_angle")) smooth_angle = reader.number("smooth_angle", 0, between(0, 180));
    const std::string file = reader.text("file");
    if (!reader.has("file")) return read_inline_mesh(reader, placement, smooth_angle);
    if (file.empty()) return;
    if (!is_mesh_file(file))
        return reader.error("file", fmt::format("is \"{}\", but a mesh is read from {}", file, mesh_extensions));
    const std::string name = placement.name.empty() ? placement.shape : placement.name;
    load_mesh_file(reader.loading(), path_beside(reader.file(), file),
                   {name, placement.material, placement.transform, smooth_angle}, reader.position_of("file"));
}

}  // namespace

void read_object(TableReader& reader, const MaterialNames& materials) {
    using ReadShape = void (*)(TableReader&, const Placement&);
    if (!reader.require({"shape"})) return reader.ignore_other_keys();
    const ReadShape read_shape = reader.choice<ReadShape>("shape", nullptr,
                                                          {{"sphere", read_sphere},
                                                           {"plane", read_plane},
                                                           {"disk", read_disk},
                                                           {"rectangle", read_rectangle},
                                                           {"box", read_box},
                                                           {"cylinder", read_round},
                                                           {"cone", read_round},
                                                           {"triangle", read_triangle},
                                                           {"mesh", read_mesh},
                                                           {"lathe", read_lathe}});
    Placement placement = read_placement(reader, materials);
    if (!read_shape) return reader.ignore_other_keys();
    placement.shape = reader.text("shape");
    read_shape(reader, placement);
}

}  // namespace raymill
