#include "scene/shapes.hpp"

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace raymill {
namespace {

constexpr double pi = glm::pi<double>();

double chord_error(double radius, std::uint32_t segments) {
    return radius * (1 - std::cos(pi / segments));
}

/// A right-handed orthonormal frame around w (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017).
struct Frame {
    glm::dvec3 u, v, w;
    explicit Frame(const glm::dvec3& axis) : w(glm::normalize(axis)) {
        const double sign = std::copysign(1.0, w.z);
        const double a = -1 / (sign + w.z);
        const double b = w.x * w.y * a;
        u = {1 + sign * w.x * w.x * a, sign * b, -sign * w.x};
        v = {b, sign + w.y * w.y * a, -w.y};
    }
    /// The direction at step i of `segments` around w, counter-clockwise seen against w.
    glm::dvec3 around(double i, std::uint32_t segments) const {
        const double angle = 2 * pi * i / segments;
        return std::cos(angle) * u + std::sin(angle) * v;
    }
};

/// Collects corners with all their attributes; duplicates cost nothing that matters at these sizes.
class MeshBuilder {
  public:
    std::uint32_t position(const glm::dvec3& p) { return add(mesh.positions, p); }
    Corner corner(std::uint32_t position, const glm::dvec3& normal, const glm::dvec2& uv) {
        return {position, add(mesh.normals, normal), add(mesh.uvs, uv)};
    }
    void triangle(const Corner& a, const Corner& b, const Corner& c) { mesh.triangles.push_back({a, b, c}); }
    void quad(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    std::vector<std::uint32_t> ring(const Frame& frame, const glm::dvec3& center, double radius) {
        std::vector<std::uint32_t> points;
        for (std::uint32_t i = 0; i < circle_segments; ++i)
            points.push_back(position(center + radius * frame.around(i, circle_segments)));
        return points;
    }
    /// A flat disk over the ring that faces along frame.w, or against it. uv maps it into the unit square.
    void cap(const Frame& frame, const glm::dvec3& center, const std::vector<std::uint32_t>& ring, bool along) {
        const glm::dvec3 normal = along ? frame.w : -frame.w;
        const auto on_ring = [&](std::uint32_t i) {
            const double angle = 2 * pi * i / circle_segments;
            return corner(ring[i], normal, glm::dvec2(0.5) + 0.5 * glm::dvec2(std::cos(angle), std::sin(angle)));
        };
        const Corner middle = corner(position(center), normal, glm::dvec2(0.5));
        for (std::uint32_t i = 0; i < circle_segments; ++i) {
            const Corner a = on_ring(i), b = on_ring((i + 1) % circle_segments);
            along ? triangle(middle, a, b) : triangle(middle, b, a);
        }
    }

    IndexedMesh mesh;

  private:
    template <class T>
    static std::uint32_t add(std::vector<T>& values, const T& value) {
        values.push_back(value);
        return static_cast<std::uint32_t>(values.size() - 1);
    }
};

/// Where the profile meets the axis like a cone, under more than `degrees` from one side to the other, the tip has no
/// normal of its own: each face gets back its own there.
void crease_tips(IndexedMesh& mesh, const glm::dvec3& center, double degrees) {
    for (auto& triangle : mesh.triangles)
        for (int c = 0; c < 3; ++c) {
            const glm::dvec3& tip = mesh.positions[triangle[c].position];
            if (tip.x != center.x || tip.z != center.z) continue;
            const glm::dvec3 a = mesh.positions[triangle[(c + 1) % 3].position] - tip;
            const glm::dvec3 b = mesh.positions[triangle[(c + 2) % 3].position] - tip;
            const glm::dvec3 normal = glm::normalize(glm::cross(a, b));
            const double fold = 2 * glm::degrees(std::acos(std::min(1.0, std::abs(normal.y))));
            if (fold <= degrees) continue;
            triangle[c].normal = static_cast<std::uint32_t>(mesh.normals.size());
            mesh.normals.push_back(normal);
        }
}

}  // namespace

IndexedMesh disk_mesh(const glm::dvec3& center, const glm::dvec3& normal, double radius) {
    MeshBuilder builder;
    const Frame frame(normal);
    builder.cap(frame, center, builder.ring(frame, center, radius), true);
    builder.mesh.chord_error = chord_error(radius, circle_segments);
    return std::move(builder.mesh);
}

IndexedMesh rectangle_mesh(const glm::dvec3& center, const glm::dvec3& edge_u, const glm::dvec3& edge_v) {
    MeshBuilder builder;
    const glm::dvec3 normal = glm::cross(edge_u, edge_v);
    const auto at = [&](double u, double v) {
        return builder.corner(builder.position(center + (u - 0.5) * edge_u + (v - 0.5) * edge_v), normal, {u, v});
    };
    const Corner a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
    builder.quad(a, b, c, d);
    return std::move(builder.mesh);
}

IndexedMesh box_mesh(const glm::dvec3& lower, const glm::dvec3& upper) {
    MeshBuilder builder;
    for (int i = 0; i < 8; ++i)
        builder.position({i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z});
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {0, 1}) {
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
            glm::dvec3 normal(0);
            normal[axis] = side ? 1 : -1;
            const auto at = [&](int i, int j) {
                const double along_u = side ? i : 1 - i;  // so that pictures are not mirrored on either side
                return builder.corner(static_cast<std::uint32_t>(base + i * u + j * v), normal, {along_u, j});
            };
            const Corner a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
            side ? builder.quad(a, b, c, d) : builder.quad(b, a, d, c);
        }
    return std::move(builder.mesh);
}

IndexedMesh cylinder_mesh(const glm::dvec3& base, const glm::dvec3& top, double radius) {
    MeshBuilder builder;
    const Frame frame(top - base);
    const auto low = builder.ring(frame, base, radius), high = builder.ring(frame, top, radius);
    for (std::uint32_t i = 0; i < circle_segments; ++i) {
        const std::uint32_t next = (i + 1) % circle_segments;
        const glm::dvec3 n = frame.around(i, circle_segments), m = frame.around(next, circle_segments);
        const double u = double(i) / circle_segments, w = double(i + 1) / circle_segments;
        builder.quad(builder.corner(low[i], n, {u, 0}), builder.corner(low[next], m, {w, 0}),
                     builder.corner(high[next], m, {w, 1}), builder.corner(high[i], n, {u, 1}));
    }
    builder.cap(frame, base, low, false);
    builder.cap(frame, top, high, true);
    builder.mesh.chord_error = chord_error(radius, circle_segments);
    return std::move(builder.mesh);
}

IndexedMesh cone_mesh(const glm::dvec3& base, const glm::dvec3& top, double radius) {
    MeshBuilder builder;
    const Frame frame(top - base);
    const double height = glm::distance(base, top);
    const auto ring = builder.ring(frame, base, radius);
    const std::uint32_t tip = builder.position(top);
    const auto normal = [&](double i) { return height * frame.around(i, circle_segments) + radius * frame.w; };
    for (std::uint32_t i = 0; i < circle_segments; ++i) {
        const std::uint32_t next = (i + 1) % circle_segments;
        const double u = double(i) / circle_segments, w = double(i + 1) / circle_segments;
        // The tip has no normal of its own: each face uses that of its middle.
        builder.triangle(builder.corner(ring[i], normal(i), {u, 0}), builder.corner(ring[next], normal(next), {w, 0}),
                         builder.corner(tip, normal(i + 0.5), {(u + w) / 2, 1}));
    }
    builder.cap(frame, base, ring, false);
    builder.mesh.chord_error = chord_error(radius, circle_segments);
    return std::move(builder.mesh);
}

IndexedMesh sphere_mesh(const glm::dvec3& center, double radius) {
    // The circle around a cell of angle d by d has angular radius d / sqrt(2): 50 bands keep its error below 1e-3.
    constexpr std::uint32_t bands = 50;
    std::vector<glm::dvec2> profile;
    for (std::uint32_t k = 0; k <= bands; ++k) {
        const double angle = pi * k / bands;
        profile.emplace_back(k == 0 || k == bands ? 0 : radius * std::sin(angle), -radius * std::cos(angle));
    }
    IndexedMesh mesh = lathe_mesh({profile, center, 2 * bands, 180});
    mesh.normals.clear();
    for (const glm::dvec3& p : mesh.positions) mesh.normals.push_back(p - center);
    for (auto& triangle : mesh.triangles)
        for (Corner& corner : triangle) corner.normal = corner.position;
    mesh.chord_error = radius * (1 - std::cos(pi / bands / std::sqrt(2.0)));
    return mesh;
}

IndexedMesh lathe_mesh(const LatheShape& shape) {
    MeshBuilder builder;
    const auto& profile = shape.profile;
    std::vector<std::vector<std::uint32_t>> rings;
    std::vector<double> along{0};
    double widest = 0;
    for (std::size_t k = 0; k < profile.size(); ++k) {
        if (k > 0) along.push_back(along.back() + glm::distance(profile[k - 1], profile[k]));
        widest = std::max(widest, profile[k].x);
        if (k + 1 == profile.size() && profile[k] == profile[0]) {
            rings.push_back(rings[0]);
            continue;
        }
        std::vector<std::uint32_t> ring;
        for (std::uint32_t i = 0; i < shape.segments && (i == 0 || profile[k].x > 0); ++i) {
            const double angle = 2 * pi * i / shape.segments;
            ring.push_back(builder.position(shape.center + glm::dvec3(profile[k].x * std::sin(angle), profile[k].y,
                                                                      profile[k].x * std::cos(angle))));
        }
        ring.resize(shape.segments, ring[0]);
        rings.push_back(std::move(ring));
    }
    const auto at = [&](std::size_t k, std::uint32_t i) {
        Corner corner = builder.corner(rings[k][i % shape.segments], glm::dvec3(0),
                                       {double(i) / shape.segments, along[k] / along.back()});
        corner.normal = NO_INDEX;
        return corner;
    };
    for (std::size_t k = 0; k + 1 < profile.size(); ++k)
        for (std::uint32_t i = 0; i < shape.segments; ++i) {
            if (profile[k].x > 0) builder.triangle(at(k, i), at(k, i + 1), at(k + 1, i));
            if (profile[k + 1].x > 0) builder.triangle(at(k, i + 1), at(k + 1, i + 1), at(k + 1, i));
        }
    builder.mesh.normals.clear();
    smooth_by_angle(builder.mesh, shape.smooth_angle);
    crease_tips(builder.mesh, shape.center, shape.smooth_angle);
    builder.mesh.chord_error = chord_error(widest, shape.segments);
    return std::move(builder.mesh);
}

}  // namespace raymill
