// OpenEXR output. Attributes beside the required ones:
//   worldToCamera, worldToNDC (M44f)   the camera, in OpenEXR's convention of row vectors times matrix
//   chromaticities                     Rec. 709 primaries, white D65
//   raymill:samplesPerPixel (int)      camera samples
//   raymill:renderTime (float)         seconds; nothing else in the file depends on the run, and its size is fixed
//   raymill:version (string)           of the program
//   raymill:scene (string)             file as it was named on the command line
//   raymill:sceneHash (string)         16 hexadecimal digits: hash of the bytes of all files of the scene
// Source: "OpenEXR File Layout" and "Standard Attributes" of the OpenEXR 3.1 documentation.
#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>
#include <sys/types.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <thread>
#include <utility>

#include "image/image.hpp"
#include "common/files.hpp"
#include "common/output_error.hpp"

namespace raymill {
namespace {

/// A stream that remembers the first failed write: OutputFile's destructor, which writes the table of lines, swallows
/// the exception.
class FileStream : public Imf::OStream {
  public:
    /// Writes to `temporary`; errors name `file`.
    FileStream(const std::string& temporary, const std::string& file)
        : OStream(file.c_str()), stream_(std::fopen(temporary.c_str(), "wb")) {
        if (!stream_) throw write_error(file, errno);
    }
    ~FileStream() override {
        if (stream_) std::fclose(stream_);
    }
    FileStream(const FileStream&) = delete;
    FileStream& operator=(const FileStream&) = delete;

    void write(const char bytes[], int count) override {
        check(std::fwrite(bytes, 1, static_cast<std::size_t>(count), stream_) == static_cast<std::size_t>(count));
    }
    std::uint64_t tellp() override { return static_cast<std::uint64_t>(::ftello(stream_)); }
    void seekp(std::uint64_t position) override {
        check(::fseeko(stream_, static_cast<off_t>(position), SEEK_SET) == 0);
    }

    /// Throws OutputError if anything at all was not written.
    void close() {
        const int closed = std::fclose(std::exchange(stream_, nullptr));
        check(first_error_ == 0 && closed == 0);
    }

  private:
    void check(bool succeeded) {
        if (succeeded) return;
        if (first_error_ == 0) first_error_ = errno;
        throw write_error(fileName(), first_error_);
    }

    std::FILE* stream_;
    int first_error_ = 0;
};

/// GLM's columns are Imath's rows: one multiplies from the left, the other from the right.
Imath::M44f imath_matrix(const glm::dmat4& matrix) {
    Imath::M44f result;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) result[i][j] = static_cast<float>(matrix[i][j]);
    return result;
}

Imf::Header make_header(const Image& image, const ImageMetadata& metadata) {
    const Imath::Box2i display({0, 0}, {metadata.full_width - 1, metadata.full_height - 1});
    const Imath::Box2i data({metadata.x0, metadata.y0},
                            {metadata.x0 + image.width - 1, metadata.y0 + image.height - 1});
    Imf::Header header(display, data);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());
    Imf::addWorldToCamera(header, imath_matrix(metadata.world_to_camera));
    Imf::addWorldToNDC(header, imath_matrix(metadata.world_to_ndc));
    header.insert("raymill:samplesPerPixel", Imf::IntAttribute(metadata.samples_per_pixel));
    header.insert("raymill:renderTime", Imf::FloatAttribute(static_cast<float>(metadata.render_seconds)));
    header.insert("raymill:version", Imf::StringAttribute(metadata.version));
    header.insert("raymill:scene", Imf::StringAttribute(metadata.scene_file));
    header.insert("raymill:sceneHash", Imf::StringAttribute(fmt::format("{:016x}", metadata.scene_hash)));
    return header;
}

Imath::half to_half(float value) {
    const Imath::half rounded(value);
    if (rounded.isInfinity() && std::isfinite(value))
        return std::copysign(static_cast<float>(std::numeric_limits<Imath::half>::max()), value);
    return rounded;
}

/// Declares the layer's channels and lends their memory to the frame buffer.
void add_channels(const ImageLayer& layer, const void* memory, Imf::PixelType type, Imf::Header& header,
                  Imf::FrameBuffer& frame_buffer) {
    const std::size_t value_size = type == Imf::HALF ? sizeof(Imath::half) : sizeof(float);
    for (std::size_t i = 0; i < layer.channels.size(); ++i) {
        header.channels().insert(layer.channels[i], Imf::Channel(type));
        frame_buffer.insert(layer.channels[i],
                            Imf::Slice::Make(type, static_cast<const char*>(memory) + i * value_size,
                                             header.dataWindow(), layer.channels.size() * value_size));
    }
}

/// Sets the number of threads by which OpenEXR compresses, for as long as this lives.
class Compressors {
  public:
    Compressors(unsigned threads, int height) : before_(Imf::globalThreadCount()) {
        const unsigned blocks = (static_cast<unsigned>(height) + lines_a_block - 1) / lines_a_block;
        const unsigned useful = std::min(threads, blocks);
        try {
            Imf::setGlobalThreadCount(useful > 1 ? static_cast<int>(useful) : 0);  // 0: the caller compresses
        } catch (const std::exception&) {  // where the system gives no threads
            Imf::setGlobalThreadCount(0);
        }
    }
    ~Compressors() { Imf::setGlobalThreadCount(before_); }
    Compressors(const Compressors&) = delete;
    Compressors& operator=(const Compressors&) = delete;

  private:
    static constexpr unsigned lines_a_block = 16;  // of ZIP_COMPRESSION
    int before_;
};

void write_layers(const std::string& file, const std::string& temporary, Imf::Header header,
                  const std::vector<const ImageLayer*>& layers, ExrPixels pixels) {
    Imf::FrameBuffer frame_buffer;
    std::vector<std::vector<Imath::half>> halves;
    for (const ImageLayer* layer : layers) {
        if (pixels == ExrPixels::half16 && !layer->full_precision) {
            std::vector<Imath::half>& memory = halves.emplace_back();
            memory.reserve(layer->values.size());
            for (const float value : layer->values) memory.push_back(to_half(value));
            add_channels(*layer, memory.data(), Imf::HALF, header, frame_buffer);
        } else {
            add_channels(*layer, layer->values.data(), Imf::FLOAT, header, frame_buffer);
        }
    }

    FileStream stream(temporary, file);
    try {
        Imf::OutputFile output(stream, header);
        output.setFrameBuffer(frame_buffer);
        output.writePixels(header.dataWindow().size().y + 1);
    } catch (const Iex::BaseExc& error) {
        throw write_error(file, error.what());
    }
    stream.close();
}

}  // namespace

void write_exr(const std::string& file, const Image& image, const std::vector<ImageLayer>& layers,
               const ImageMetadata& metadata, ExrPixels pixels, unsigned threads) {
    assert(image.width > 0 && image.height > 0);
    assert(image.rgba.size() == 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    const ImageLayer beauty{{"R", "G", "B", "A"}, image.rgba, false};
    std::vector<const ImageLayer*> all = {&beauty};
    for (const ImageLayer& layer : layers) all.push_back(&layer);
    const Imf::Header header = make_header(image, metadata);
    const Compressors compressors(threads > 0 ? threads : std::thread::hardware_concurrency(), image.height);
    write_atomically(file, [&](const std::string& temporary) { write_layers(file, temporary, header, all, pixels); });
}

}  // namespace raymill
