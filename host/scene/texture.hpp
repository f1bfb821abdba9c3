// Pictures that a scene names: PNG, JPEG, BMP, TGA, Radiance HDR and OpenEXR, decoded to linear RGB.
#pragma once

#include <string>

#include "scene/loading.hpp"

namespace raymill {

/// Decodes a picture by its magic number. 8- and 16-bit formats are sRGB-decoded (IEC 61966-2-1), HDR and EXR are
/// linear. Alpha is ignored. Texels that are negative or not finite become 0; `mended` counts them. Throws
/// std::runtime_error with the reason for a damaged, unknown or too large (over 2^27 texels) picture.
TextureImage decode_texture(const std::string& bytes, const std::string& file, std::size_t& mended);

/// The same for OpenEXR: its data window, from R G B, or Y, or luminance and chroma.
TextureImage decode_exr(const std::string& bytes, const std::string& file);

/// Throws std::runtime_error if a picture of this size is refused: none of a file this small can be true to it.
void check_texture_size(double width, double height, std::size_t file_bytes);

/// The means of red, green, blue and alpha as the file has them, in [0, 1] and not sRGB-decoded: for pictures of
/// numbers rather than colours. Throws as decode_texture.
glm::dvec4 mean_of_channels(const std::string& bytes);

/// Adds a picture from memory under a name of its own, such as "model.glb: images[2]", at most once. A damaged one is
/// an error at `named_at` and nothing is returned.
std::optional<std::uint32_t> add_texture(Loading& loading, const std::string& name, const std::string& bytes,
                                         const SourcePosition& named_at);

/// The index into Scene::images of the picture, read at most once. A damaged one is an error that names the file;
/// a missing one an error at `named_at`, or a warning if `optional`; nothing is returned for either.
std::optional<std::uint32_t> load_texture(Loading& loading, const std::string& path, const SourcePosition& named_at,
                                          bool optional);

}  // namespace raymill
