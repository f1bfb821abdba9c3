#include "scene/texture.hpp"

#include <fmt/format.h>

#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include <array>
#include <climits>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "scene/color.hpp"

namespace raymill {
namespace {

struct FreePixels {
    void operator()(void* pixels) const { stbi_image_free(pixels); }
};

template <class T>
using Pixels = std::unique_ptr<T[], FreePixels>;

template <class T, class Decode>
void copy_texels(TextureImage& image, const Pixels<T>& pixels, Decode decode) {
    if (!pixels) throw std::runtime_error(stbi_failure_reason() ? stbi_failure_reason() : "damaged");
    image.texels.resize(std::size_t{image.width} * image.height);
    for (std::size_t i = 0; i < image.texels.size(); ++i)
        image.texels[i] = {decode(pixels[3 * i]), decode(pixels[3 * i + 1]), decode(pixels[3 * i + 2])};
}

struct PictureSize {
    std::uint32_t width, height;
};

/// The size that a picture of stb's formats claims; throws for another format and for a size that is refused.
PictureSize checked_size(const std::string& bytes) {
    if (bytes.size() > INT_MAX) throw std::runtime_error("larger than 2 GiB");
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &width,
                               &height, &channels)) {
        const char* why = stbi_failure_reason();
        const bool unknown = !why || std::string(why) == "unknown image type";
        throw std::runtime_error(unknown ? "not a PNG, JPEG, BMP, TGA, HDR or EXR picture" : why);
    }
    check_texture_size(width, height, bytes.size());
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

TextureImage decode_stb(const std::string& bytes, const std::string& file) {
    const auto [checked_width, checked_height] = checked_size(bytes);
    TextureImage image{file, checked_width, checked_height, {}};
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, channels = 0;
    if (stbi_is_hdr_from_memory(data, size)) {
        const Pixels<float> pixels(stbi_loadf_from_memory(data, size, &width, &height, &channels, 3));
        copy_texels(image, pixels, [](float value) { return value; });
    } else if (stbi_is_16_bit_from_memory(data, size)) {
        const Pixels<stbi_us> pixels(stbi_load_16_from_memory(data, size, &width, &height, &channels, 3));
        copy_texels(image, pixels, [](stbi_us v) { return static_cast<float>(srgb_to_linear(v / 65535.0)); });
    } else {
        std::array<float, 256> linear;
        for (int i = 0; i < 256; ++i) linear[i] = static_cast<float>(srgb_to_linear(i / 255.0));
        const Pixels<stbi_uc> pixels(stbi_load_from_memory(data, size, &width, &height, &channels, 3));
        copy_texels(image, pixels, [&](stbi_uc v) { return linear[v]; });
    }
    return image;
}

}  // namespace

void check_texture_size(double width, double height, std::size_t file_bytes) {
    constexpr double most_texels = 1 << 27;
    if (!(width >= 1 && height >= 1)) throw std::runtime_error("it has no pixels");
    if (width * height > most_texels)
        throw std::runtime_error(fmt::format("{} x {} pixels are more than the 2^27 that are read", width, height));
    // No compression that is read here packs more than 2^14 pixels into a byte, apart from small overheads.
    if (width * height > (double(file_bytes) + 1024) * 16384)
        throw std::runtime_error(fmt::format("its {} bytes cannot hold {} x {} pixels", file_bytes, width, height));
}

TextureImage decode_texture(const std::string& bytes, const std::string& file, std::size_t& mended) {
    TextureImage image = bytes.starts_with("\x76\x2f\x31\x01") ? decode_exr(bytes, file) : decode_stb(bytes, file);
    mended = 0;
    for (glm::vec3& texel : image.texels)
        for (int c = 0; c < 3; ++c)
            if (!(texel[c] >= 0 && std::isfinite(texel[c]))) {
                texel[c] = 0;
                ++mended;
            }
    return image;
}

glm::dvec4 mean_of_channels(const std::string& bytes) {
    const auto [width, height] = checked_size(bytes);
    int w = 0, h = 0, channels = 0;
    const Pixels<stbi_uc> pixels(stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                                       static_cast<int>(bytes.size()), &w, &h, &channels, 4));
    if (!pixels) throw std::runtime_error(stbi_failure_reason() ? stbi_failure_reason() : "damaged");
    std::array<std::uint64_t, 4> sums{};
    const std::size_t count = std::size_t{width} * height;
    for (std::size_t i = 0; i < 4 * count; ++i) sums[i % 4] += pixels[i];
    const double scale = 1 / (255.0 * static_cast<double>(count));
    return glm::dvec4(double(sums[0]), double(sums[1]), double(sums[2]), double(sums[3])) * scale;
}

std::optional<std::uint32_t> add_texture(Loading& loading, const std::string& name, const std::string& bytes,
                                         const SourcePosition& named_at) {
    const auto [entry, is_new] = loading.textures.try_emplace(name);
    if (!is_new) return entry->second;
    try {
        std::size_t mended = 0;
        TextureImage image = decode_texture(bytes, name, mended);
        if (mended > 0)
            loading.warn({name}, fmt::format("{} values are negative or not finite and are read as 0", mended));
        loading.scene.images.push_back(std::move(image));
        entry->second = static_cast<std::uint32_t>(loading.scene.images.size() - 1);
    } catch (const std::bad_alloc&) {
        loading.error(named_at, fmt::format("there is not enough memory for the texture \"{}\"", name));
    } catch (const std::exception& fault) {
        loading.error(named_at, fmt::format("cannot decode the texture \"{}\": {}", name, fault.what()));
    }
    return entry->second;
}

std::optional<std::uint32_t> load_texture(Loading& loading, const std::string& path, const SourcePosition& named_at,
                                          bool optional) {
    if (const auto known = loading.textures.find(path); known != loading.textures.end()) return known->second;
    std::string reason;
    const std::optional<std::string> bytes = loading.files.read(path, reason);
    if (bytes) return add_texture(loading, path, *bytes, named_at);
    const std::string message = fmt::format("cannot read the texture \"{}\": {}", path, reason);
    optional ? loading.warn(named_at, message) : loading.error(named_at, message);
    loading.textures.emplace(path, std::nullopt);
    return std::nullopt;
}

}  // namespace raymill
