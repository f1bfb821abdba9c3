// The picture format that a file name asks for.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "image/image.hpp"

namespace raymill {

ImageFormat image_format(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".exr") return ImageFormat::exr;
    if (extension == ".png") return ImageFormat::png;
    throw UsageError(
        fmt::format("Cannot tell the format of the output file '{}' from its name; "
                    "let the name end in .exr or .png.",
                    file));
}

}  // namespace raymill
