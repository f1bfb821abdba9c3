// A rendered EXR file read back, whatever wrote it.
#pragma once

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPixelType.h>

#include <map>
#include <string>
#include <vector>

namespace raymill {

struct Picture {
    Imf::Header header;
    int x0 = 0, y0 = 0, width = 0, height = 0;  // data window
    std::vector<float> rgba;

    /// Red, green, blue and alpha at a pixel of the whole image.
    const float* at(int x, int y) const {
        return rgba.data() + 4 * (static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(x - x0));
    }
};

/// Throws what OpenEXR throws if the file is missing, damaged, or not complete.
Picture read_picture(const std::string& file);

/// A channel of any name, row by row from the top of the data window.
struct Channel {
    Imf::PixelType type = Imf::NUM_PIXELTYPES;  // in the file
    std::vector<float> values;
};

/// All channels by name. Throws what OpenEXR throws.
std::map<std::string, Channel> read_channels(const std::string& file);

/// Whether both have the same windows and the same bits in every pixel.
bool same_pixels(const Picture& a, const Picture& b);

}  // namespace raymill
