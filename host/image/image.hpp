// Pictures on disk: OpenEXR and PNG, written whole or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"

namespace raymill {

/// Linear RGBA, row by row from the top left of the window.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<float> rgba;  // 4 * width * height
};

/// More channels of the same pixels.
struct ImageLayer {
    std::vector<std::string> channels;  // full names in OpenEXR's convention, for example "N.X", "N.Y", "N.Z"
    std::vector<float> values;          // interleaved, channels.size() a pixel
    bool full_precision = false;        // 32 bits even where the picture has 16: distances, ids
};

/// Goes into the EXR header: what made the picture. The file's attributes are named in exr.cpp.
struct ImageMetadata {
    int full_width = 0;  // display window
    int full_height = 0;
    int x0 = 0;  // where the image's top left pixel lies in it: the data window
    int y0 = 0;
    glm::dmat4 world_to_camera{1};  // both multiply column vectors from the left, as everywhere with GLM;
    glm::dmat4 world_to_ndc{1};     // the file holds what OpenEXR expects of worldToCamera and worldToNDC
    int samples_per_pixel = 0;
    double render_seconds = 0;  // the one attribute in which two renders of a scene differ
    std::uint64_t scene_hash = 0;
    std::string scene_file;
    std::string version;
};

/// float32 keeps every bit. half16 rounds to nearest, ties to even; finite values beyond the largest half (65504)
/// become the largest half rather than infinite.
enum class ExrPixels { float32, half16 };

enum class ImageFormat { exr, png };

/// What the extension of `file` (.exr or .png, in any case) asks for. Throws UsageError for any other.
ImageFormat image_format(const std::string& file);

/// Channels R G B A and those of the layers, ZIP compression by so many threads, 0 for all; the file does not depend on
/// their number. Not at the same time as anything else of OpenEXR, which has one pool of threads. Atomic as
/// write_atomically is. Throws OutputError.
void write_exr(const std::string& file, const Image& image, const std::vector<ImageLayer>& layers,
               const ImageMetadata& metadata, ExrPixels pixels, unsigned threads = 0);

/// 8-bit sRGB after 2^exposure, values clamped to [0, 1] and NaN black; opaque, whatever the image's alpha.
/// Atomic as write_atomically is. Throws OutputError.
void write_png(const std::string& file, const Image& image, double exposure);

}  // namespace raymill
