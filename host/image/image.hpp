// Pictures on disk: OpenEXR and PNG, written whole or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace raymill {

/// Linear RGBA, row by row from the top left of the window.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<float> rgba;  // 4 * width * height
};

/// Goes into the EXR header: what made the picture.
struct ImageMetadata {
    int full_width = 0;  // display window
    int full_height = 0;
    int x0 = 0;  // where the image's top left pixel lies in it: the data window
    int y0 = 0;
    glm::dmat4 world_to_camera{1};  // OpenEXR's worldToCamera / worldToNDC conventions
    glm::dmat4 world_to_ndc{1};
    int samples_per_pixel = 0;
    double render_seconds = 0;
    std::uint64_t scene_hash = 0;
    std::string scene_file;
    std::string version;
};

enum class ExrPixels { float32, half16 };

/// Calls write(temporary path) and renames the result to `file`; on any failure neither is left behind.
/// Throws OutputError with what failed and why.
void write_atomically(const std::string& file, const std::function<void(const std::string& temporary)>& write);

/// Throws OutputError if `file` could not be created (folder missing, no permission), without touching it.
void check_writable(const std::string& file);

/// Channels R G B A. Throws OutputError.
void write_exr(const std::string& file, const Image& image, const ImageMetadata& metadata, ExrPixels pixels);

/// 8-bit sRGB after 2^exposure, values clamped to [0, 1]; alpha is written as 255. Throws OutputError.
void write_png(const std::string& file, const Image& image, double exposure);

}  // namespace raymill
