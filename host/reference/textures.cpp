#include "reference/textures.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace raymill::reference {

namespace {

long wrapped(double i, long size) {
    const double remainder = std::fmod(i, static_cast<double>(size));
    return static_cast<long>(remainder < 0 ? remainder + static_cast<double>(size) : remainder);
}

long clamped(double i, long size) {
    return static_cast<long>(std::clamp(i, 0.0, static_cast<double>(size - 1)));
}

/// x and y in texels from the picture's upper left corner, wrapped in x and by `row` in y.
dvec3 bilinear(const TextureImage& image, double x, double y, long (*row)(double, long)) {
    const double left = std::floor(x - 0.5);
    const double top = std::floor(y - 0.5);
    const double fx = x - 0.5 - left;
    const double fy = y - 0.5 - top;
    const auto texel = [&](double i, double j) {
        return dvec3(
            image.texels[static_cast<std::size_t>(row(j, image.height) * image.width + wrapped(i, image.width))]);
    };
    return glm::mix(glm::mix(texel(left, top), texel(left + 1, top), fx),
                    glm::mix(texel(left, top + 1), texel(left + 1, top + 1), fx), fy);
}

}  // namespace

dvec3 texture_color(const TextureImage& image, const dvec2& uv) {
    return bilinear(image, uv.x * image.width, (1 - uv.y) * image.height, wrapped);
}

dvec3 environment_color(const TextureImage& image, const dvec3& direction) {
    const double longitude = std::atan2(direction.x, direction.z);
    const double latitude = std::asin(std::clamp(direction.y, -1.0, 1.0));
    const double x = (0.5 - longitude / glm::two_pi<double>()) * image.width;
    const double y = (0.5 - latitude / glm::pi<double>()) * image.height;
    return bilinear(image, x, y, clamped);
}

dvec3 checker_color(const Checker& checker, const dvec3& position) {
    const dvec3 cell = glm::floor(position / static_cast<double>(checker.scale) + 1.0 / 4096);
    const bool odd = std::fmod(cell.x + cell.y + cell.z, 2.0) != 0;
    return odd ? checker.b : checker.a;
}

}  // namespace raymill::reference
