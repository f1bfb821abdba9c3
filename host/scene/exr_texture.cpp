// OpenEXR pictures from memory.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfRgbaFile.h>

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

void read_channels(Imf::InputFile& file, const Imath::Box2i& window, TextureImage& image) {
    const bool grey = !file.header().channels().findChannel("R");
    Imf::FrameBuffer frame;
    const char* names[] = {"R", "G", "B"};
    for (int c = 0; c < (grey ? 1 : 3); ++c)
        frame.insert(grey ? "Y" : names[c], float_slice(&image.texels[0][c], window, image.width));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    if (grey)
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

}  // namespace

TextureImage decode_exr(const std::string& bytes, const std::string& name) {
    MemoryStream stream(bytes, name);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    const double width = double(window.max.x) - window.min.x + 1, height = double(window.max.y) - window.min.y + 1;
    check_texture_size(width, height, bytes.size());
    TextureImage image{name, std::uint32_t(width), std::uint32_t(height), {}};
    image.texels.resize(std::size_t{image.width} * image.height);

    const Imf::ChannelList& channels = file.header().channels();
    const bool has_rgb = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    const bool has_chroma = channels.findChannel("RY") && channels.findChannel("BY");
    if (has_rgb || (channels.findChannel("Y") && !has_chroma)) {
        read_channels(file, window, image);
    } else if (channels.findChannel("Y")) {
        stream.seekg(0);
        read_luminance_chroma(stream, window, image);
    } else {
        throw std::runtime_error("it has neither the channels R, G, B nor Y");
    }
    return image;
}

}  // namespace raymill
