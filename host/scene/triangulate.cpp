// Ear clipping (Meisters 1975; O'Rourke, Computational Geometry in C, section 1.4).
#include <cmath>

#include "scene/mesh.hpp"

namespace raymill {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Twice the signed area of a, b, c: positive where they turn left.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return cross(b - a, c - a);
}

/// The polygon in a plane where it runs counter-clockwise: the axis in which its Newell normal is longest is dropped.
void project(std::span<const glm::dvec3> corners, std::span<glm::dvec2> flat) {
    glm::dvec3 normal(0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        // Relative to a corner, for precision far from the origin.
        const glm::dvec3 a = corners[i] - corners[0];
        normal += glm::cross(a, corners[(i + 1) % corners.size()] - corners[0]);
    }
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    for (std::size_t i = 0; i < corners.size(); ++i)
        flat[i] = {corners[i][u] - corners[0][u], corners[i][v] - corners[0][v]};
}

void split_quad(std::span<const glm::dvec3> corners, Triangles& triangles) {
    std::array<glm::dvec2, 4> p;
    project(corners, p);
    const bool diagonal_02 = turn(p[0], p[1], p[2]) > 0 && turn(p[0], p[2], p[3]) > 0;
    const bool diagonal_13 = turn(p[1], p[2], p[3]) > 0 && turn(p[0], p[1], p[3]) > 0;
    const bool shorter_02 = glm::distance(corners[0], corners[2]) <= glm::distance(corners[1], corners[3]);
    if (diagonal_02 == diagonal_13 ? shorter_02 : diagonal_02) {
        triangles.push_back({0, 1, 2});
        triangles.push_back({0, 2, 3});
    } else {
        triangles.push_back({0, 1, 3});
        triangles.push_back({1, 2, 3});
    }
}

class EarClipper {
  public:
    explicit EarClipper(std::span<const glm::dvec3> corners)
        : points_(corners.size()), next_(corners.size()), previous_(corners.size()) {
        project(corners, points_);
        const auto count = static_cast<std::uint32_t>(corners.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            next_[i] = (i + 1) % count;
            previous_[i] = (i + count - 1) % count;
        }
        // Only a corner that does not turn left can lie in an ear, and clipping never makes another one.
        for (std::uint32_t i = 0; i < count; ++i)
            if (!(turn_at(i) > 0)) reflex_.push_back(i);
    }

    void clip(Triangles& triangles) {
        std::uint32_t left = static_cast<std::uint32_t>(points_.size());
        std::uint32_t at = 0, refused = 0;
        bool crosses_itself = false;
        while (left > 3) {
            // After a whole round without an ear the polygon crosses itself: cut the rest without asking, to end.
            crosses_itself = crosses_itself || refused == left;
            if (!crosses_itself && !is_ear(at)) {
                at = next_[at];
                ++refused;
                continue;
            }
            triangles.push_back({previous_[at], at, next_[at]});
            const std::uint32_t before = previous_[at], after = next_[at];
            next_[before] = after;
            previous_[after] = before;
            next_[at] = at;  // marks it as gone
            at = next_[after];
            refused = 0;
            --left;
        }
        triangles.push_back({previous_[at], at, next_[at]});
    }

  private:
    double turn_at(std::uint32_t i) const { return turn(points_[previous_[i]], points_[i], points_[next_[i]]); }

    bool is_ear(std::uint32_t i) const {
        if (!(turn_at(i) > 0)) return false;
        const std::uint32_t a = previous_[i], c = next_[i];
        for (const std::uint32_t other : reflex_) {
            if (other == a || other == i || other == c || next_[other] == other) continue;
            const glm::dvec2& p = points_[other];
            if (p == points_[a] || p == points_[i] || p == points_[c]) continue;  // a slit touches itself
            if (turn(points_[a], points_[i], p) >= 0 && turn(points_[i], points_[c], p) >= 0 &&
                turn(points_[c], points_[a], p) >= 0)
                return false;
        }
        return true;
    }

    std::vector<glm::dvec2> points_;
    std::vector<std::uint32_t> next_, previous_, reflex_;
};

}  // namespace

void triangulate(std::span<const glm::dvec3> corners, Triangles& triangles) {
    if (corners.size() == 3)
        triangles.push_back({0, 1, 2});
    else if (corners.size() == 4)
        split_quad(corners, triangles);
    else if (corners.size() > 4)
        EarClipper(corners).clip(triangles);
}

}  // namespace raymill
