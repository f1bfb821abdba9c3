#include "exr_pixels.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>

#include <cstring>
#include <stdexcept>

namespace raymill {

Picture read_picture(const std::string& file) {
    Imf::InputFile input(file.c_str());
    if (!input.isComplete()) throw std::runtime_error(file + " is not complete");
    const Imath::Box2i window = input.header().dataWindow();
    Picture picture{input.header(), window.min.x, window.min.y, window.size().x + 1, window.size().y + 1, {}};
    picture.rgba.resize(4 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
    Imf::FrameBuffer frame_buffer;
    for (std::size_t i = 0; i < 4; ++i)
        frame_buffer.insert(std::string(1, "RGBA"[i]),
                            Imf::Slice::Make(Imf::FLOAT, picture.rgba.data() + i, window, 4 * sizeof(float)));
    input.setFrameBuffer(frame_buffer);
    input.readPixels(window.min.y, window.max.y);
    return picture;
}

std::map<std::string, Channel> read_channels(const std::string& file) {
    Imf::InputFile input(file.c_str());
    const Imath::Box2i window = input.header().dataWindow();
    const Imath::V2i size = window.size() + Imath::V2i(1);
    std::map<std::string, Channel> channels;
    Imf::FrameBuffer frame_buffer;
    const Imf::ChannelList& list = input.header().channels();
    for (auto entry = list.begin(); entry != list.end(); ++entry) {
        Channel& channel = channels[entry.name()];
        channel.type = entry.channel().type;
        channel.values.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
        frame_buffer.insert(entry.name(), Imf::Slice::Make(Imf::FLOAT, channel.values.data(), window));
    }
    input.setFrameBuffer(frame_buffer);
    input.readPixels(window.min.y, window.max.y);
    return channels;
}

bool same_pixels(const Picture& a, const Picture& b) {
    return a.x0 == b.x0 && a.y0 == b.y0 && a.width == b.width && a.height == b.height &&
           std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0;
}

}  // namespace raymill
