#include "scene/vertex_colors.hpp"

#include <bit>
#include <cmath>
#include <string_view>
#include <unordered_map>

namespace raymill {
namespace {

using Triple = std::array<glm::vec3, 3>;

struct TripleHash {
    std::size_t operator()(const Triple& triple) const {
        return std::hash<std::string_view>()({reinterpret_cast<const char*>(triple.data()), sizeof triple});
    }
};

/// The image of `blocks` blocks. Its sides are powers of two, so that the uvs of texel centres are exact floats.
TextureImage image_for(std::size_t blocks, const std::string& name) {
    const std::size_t texels = std::bit_ceil(4 * blocks);
    const auto width = std::uint32_t{2} << (std::bit_width(texels) - 2) / 2;
    return {name, width, static_cast<std::uint32_t>(texels / width), std::vector<glm::vec3>(texels)};
}

void fill_block(TextureImage& image, std::size_t x, std::size_t y, const Triple& triple) {
    const auto& [a, b, c] = triple;
    image.texels[y * image.width + x] = a;
    image.texels[y * image.width + x + 1] = b;
    image.texels[(y + 1) * image.width + x] = c;
    image.texels[(y + 1) * image.width + x + 1] = b + c - a;
}

}  // namespace

BakedColors bake_colors(Scene& scene, ColoredMesh& mesh, const std::string& name) {
    std::unordered_map<Triple, std::uint32_t, TripleHash> known;
    std::vector<Triple> triples;
    std::vector<std::uint32_t> block_of_triangle;
    block_of_triangle.reserve(mesh.corner_colors.size());
    for (const auto& [a, b, c] : mesh.corner_colors) {
        const Triple triple{mesh.colors[a] + 0.0f, mesh.colors[b] + 0.0f, mesh.colors[c] + 0.0f};  // -0 becomes 0
        const auto [entry, is_new] = known.try_emplace(triple, static_cast<std::uint32_t>(triples.size()));
        if (is_new) triples.push_back(triple);
        block_of_triangle.push_back(entry->second);
    }
    if (triples.empty()) return {};
    if (triples.size() == 1 && triples[0][0] == triples[0][1] && triples[0][0] == triples[0][2])
        return {triples[0][0], std::nullopt};

    TextureImage image = image_for(triples.size(), name);
    mesh.uvs.clear();
    for (std::size_t block = 0; block < triples.size(); ++block) {
        const std::size_t x = 2 * (block % (image.width / 2)), y = 2 * (block / (image.width / 2));
        fill_block(image, x, y, triples[block]);
        const glm::dvec2 texel(1.0 / image.width, -1.0 / image.height);
        const glm::dvec2 first = glm::dvec2(0, 1) + (glm::dvec2(double(x), double(y)) + 0.5) * texel;
        mesh.uvs.insert(mesh.uvs.end(), {first, {first.x + texel.x, first.y}, {first.x, first.y + texel.y}});
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::uint32_t c = 0; c < 3; ++c) mesh.triangles[t][c].uv = 3 * block_of_triangle[t] + c;
    scene.images.push_back(std::move(image));
    return {glm::vec3(1), static_cast<std::uint32_t>(scene.images.size() - 1)};
}

}  // namespace raymill
