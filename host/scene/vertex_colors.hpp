// Colours at vertices, as a texture: the scene has no others.
#pragma once

#include "scene/loading.hpp"
#include "scene/mesh.hpp"

namespace raymill {

/// A mesh with linear colours at the corners of its triangles.
struct ColoredMesh : IndexedMesh {
    std::vector<glm::vec3> colors;
    std::vector<std::array<std::uint32_t, 3>> corner_colors;  // one a triangle, into colors; or empty: no colours
};

/// What multiplies the diffuse colour of the triangles: one colour, and an image where they are not all alike.
struct BakedColors {
    glm::vec3 color{1};
    std::optional<std::uint32_t> image;  // into Scene::images
};

/// Replaces the uvs of the mesh such that the image, added to the scene, shows its colours: each distinct triple takes
/// 2 x 2 texels a, b / c, b + c - a, between whose centres the bilinear filter is the linear interpolation over the
/// triangle. The last texel may be negative; no triangle reaches it.
BakedColors bake_colors(Scene& scene, ColoredMesh& mesh, const std::string& name);

}  // namespace raymill
