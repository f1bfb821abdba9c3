// Colours that vary over a surface or over directions.
#pragma once

#include <glm/glm.hpp>

#include "scene/scene.hpp"

namespace raymill::reference {

using glm::dvec2;
using glm::dvec3;

/// Bilinear lookup that repeats. Texel centres lie at (i + 0.5) / size; v = 0 is the lower edge of the picture.
/// The image must not be empty.
dvec3 texture_color(const TextureImage& image, const dvec2& uv);

/// Radiance of a latitude-longitude map from a unit direction. +y is up, +z the picture's middle, +x its left quarter:
/// the orientation of OpenEXR's ENVMAP_LATLONG (ImfEnvmap.h), with Raymill's texel centres.
/// Bilinear, around horizontally, up to the pole's texels vertically.
dvec3 environment_color(const TextureImage& image, const dvec3& direction);

/// The checker's colour at a point in world space.
dvec3 checker_color(const Checker& checker, const dvec3& position);

}  // namespace raymill::reference
