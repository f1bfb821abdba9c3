// PNG output through libpng's simplified interface, which declares 8-bit images as sRGB by an sRGB chunk.
#include <png.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <ranges>
#include <string>
#include <vector>

#include "image/image.hpp"
#include "common/files.hpp"
#include "common/output_error.hpp"
#include "image/srgb.hpp"

namespace raymill {

std::uint8_t srgb_code(double linear) {
    if (!(linear > 0)) return 0;  // NaN too
    if (linear >= 1) return 255;
    const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

SrgbEncoder::SrgbEncoder() {
    const auto code_of_bits = [](std::uint32_t bits) { return int{srgb_code(double{std::bit_cast<float>(bits)})}; };
    const auto up_to_one = std::views::iota(0u, std::bit_cast<std::uint32_t>(1.0f) + 1);
    least_.fill(std::numeric_limits<float>::infinity());
    for (int code = 0; code < 256; ++code)
        least_[static_cast<std::size_t>(code)] =
            std::bit_cast<float>(*std::ranges::lower_bound(up_to_one, code, {}, code_of_bits));
    std::uint8_t code = 0;
    for (std::uint32_t i = 0; i < intervals; ++i) {
        while (std::bit_cast<float>(i << interval_bits) >= least_[code + 1u]) ++code;
        first_[i] = code;
        assert(i == 0 || first_[i] - first_[i - 1] <= 1);
    }
    assert(code >= 254);
}

namespace {

std::vector<std::uint8_t> encode(const Image& image, double exposure) {
    const SrgbEncoder srgb;
    const double scale = std::exp2(exposure);
    std::vector<std::uint8_t> rgb(image.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < rgb.size(); ++i)
        rgb[i] = srgb.code(static_cast<float>(std::min(scale * image.rgba[i / 3 * 4 + i % 3], 1.0)));
    return rgb;
}

void write_rgb(const std::string& file, const std::string& temporary, const Image& image,
               const std::vector<std::uint8_t>& rgb) {
    const auto close = [](std::FILE* stream) { std::fclose(stream); };
    std::unique_ptr<std::FILE, decltype(close)> stream(std::fopen(temporary.c_str(), "wb"), close);
    if (!stream) throw write_error(file, errno);

    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    png.flags = PNG_IMAGE_FLAG_FAST;  // one filter, and little searching for what repeats
    errno = 0;  // libpng says that a write failed, the system why
    if (png_image_write_to_stdio(&png, stream.get(), 0, rgb.data(), 0, nullptr) == 0)
        throw errno != 0 ? write_error(file, errno) : write_error(file, png.message);
    if (std::fclose(stream.release()) != 0) throw write_error(file, errno);
}

}  // namespace

void write_png(const std::string& file, const Image& image, double exposure) {
    assert(image.rgba.size() == 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    const std::vector<std::uint8_t> rgb = encode(image, exposure);
    write_atomically(file, [&](const std::string& temporary) { write_rgb(file, temporary, image, rgb); });
}

}  // namespace raymill
