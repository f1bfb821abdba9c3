// OpenEXR pictures from memory.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfRgbaFile.h>
#include <ImfTileDescriptionAttribute.h>

#include <cstring>
#include <limits>
#include <stdexcept>

#include "scene/texture.hpp"

namespace raymill {
namespace {

/// OpenEXR's view of bytes in memory.
class MemoryStream : public Imf::IStream {
  public:
    MemoryStream(const std::string& bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

    bool read(char c[], int n) override {
        if (n < 0 || std::uint64_t(n) > bytes_.size() - at_) throw std::runtime_error("it ends too early");
        std::memcpy(c, bytes_.data() + at_, std::size_t(n));
        at_ += std::size_t(n);
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t position) override {
        if (position > bytes_.size()) throw std::runtime_error("it refers beyond its end");
        at_ = position;
    }

  private:
    const std::string& bytes_;
    std::size_t at_ = 0;
};

/// A slice whose pixel (x, y) of the data window lies at base[(y - min.y) * width + x - min.x].
Imf::Slice float_slice(float* base, const Imath::Box2i& window, std::size_t width) {
    constexpr std::size_t x_stride = sizeof(glm::vec3);
    return Imf::Slice::Make(Imf::FLOAT, base, window, x_stride, width * x_stride);
}

void read_channels(Imf::InputFile& file, const std::vector<std::string>& names, const Imath::Box2i& window,
                   TextureImage& image) {
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < names.size(); ++c)
        frame.insert(names[c], float_slice(&image.texels[0][static_cast<int>(c)], window, image.width));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    if (names.size() == 1)
        for (glm::vec3& texel : image.texels) texel = glm::vec3(texel.x);
}

void read_luminance_chroma(MemoryStream& stream, const Imath::Box2i& window, TextureImage& image) {
    Imf::RgbaInputFile file(stream);
    std::vector<Imf::Rgba> row(image.width);
    for (int y = window.min.y; y <= window.max.y; ++y) {
        // The frame buffer's origin is pixel (0, 0), which may lie outside the row: integer arithmetic, as OpenEXR
        // does.
        const std::intptr_t origin = reinterpret_cast<std::intptr_t>(row.data()) -
                                     std::intptr_t(window.min.x) * std::intptr_t(sizeof(Imf::Rgba));
        file.setFrameBuffer(reinterpret_cast<Imf::Rgba*>(origin), 1, 0);
        file.readPixels(y);
        glm::vec3* texels = &image.texels[std::size_t(y - window.min.y) * image.width];
        for (std::size_t x = 0; x < row.size(); ++x) texels[x] = {row[x].r, row[x].g, row[x].b};
    }
}

/// The data window of the file's first part, checked before OpenEXR asks for memory and time in proportion to it.
Imath::Box2i checked_data_window(MemoryStream& stream, std::size_t file_bytes, TextureImage& image) {
    char magic_and_version[8];
    stream.read(magic_and_version, sizeof magic_and_version);
    int version = static_cast<unsigned char>(magic_and_version[4]);
    for (int i = 1; i < 4; ++i) version |= static_cast<unsigned char>(magic_and_version[4 + i]) << 8 * i;
    Imf::Header header;
    header.readFrom(stream, version);
    stream.seekg(0);
    const Imath::Box2i window = header.dataWindow();
    const double width = double(window.max.x) - window.min.x + 1, height = double(window.max.y) - window.min.y + 1;
    check_texture_size(width, height, file_bytes);
    // Scan lines come in blocks of 256 at most, each with eight bytes in the table of offsets.
    if (!header.hasTileDescription() && height / 256 * 8 > double(file_bytes))
        throw std::runtime_error("its table of lines is longer than the file");
    image.width = static_cast<std::uint32_t>(width);
    image.height = static_cast<std::uint32_t>(height);
    return window;
}

/// R, G and B, or the one channel that stands for grey; none where luminance comes with chroma.
std::vector<std::string> plain_channels(const Imf::ChannelList& channels) {
    if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B")) return {"R", "G", "B"};
    if (channels.findChannel("RY") && channels.findChannel("BY")) return {};
    if (channels.findChannel("Y")) return {"Y"};
    auto first = channels.begin();
    if (first != channels.end() && ++channels.begin() == channels.end()) return {first.name()};
    throw std::runtime_error("it has neither the channels R, G, B nor Y");
}

}  // namespace

TextureImage decode_exr(const std::string& bytes, const std::string& name) {
    MemoryStream stream(bytes, name);
    TextureImage image{name, 0, 0, {}};
    const Imath::Box2i window = checked_data_window(stream, bytes.size(), image);
    Imf::InputFile file(stream, 0);
    const std::vector<std::string> channels = plain_channels(file.header().channels());
    image.texels.resize(std::size_t{image.width} * image.height);
    if (channels.empty()) {
        stream.seekg(0);
        read_luminance_chroma(stream, window, image);
    } else {
        read_channels(file, channels, window, image);
    }
    return image;
}

}  // namespace raymill
