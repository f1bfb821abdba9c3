#include "capture/capture_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <concepts>
#include <cstring>
#include <ostream>

#include "common/error.hpp"
#include "common/files.hpp"
#include "device/kernel_source.hpp"
#include "scene/loading.hpp"

namespace raymill::capture {

namespace {

static_assert(std::endian::native == std::endian::little, "a big-endian host must swap the words of a capture");

constexpr std::string_view magic = "RAYQUEUE";
constexpr std::size_t version_at = 8, size_at = 12, checksum_at = 20, payload_at = 28;

std::uint64_t fnv1a(std::string_view bytes) {
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const char byte : bytes) h = (h ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
    return h;
}

class Writer {
  public:
    template <class T>
    requires std::integral<T> || std::floating_point<T>
    void operator()(T& value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
    void operator()(std::string& text) {
        length(text.size());
        bytes_ += text;
    }
    template <class T>
    void operator()(std::vector<T>& items) {
        length(items.size());
        bytes_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
    }
    const std::string& bytes() const { return bytes_; }

  private:
    void length(std::uint64_t count) { (*this)(count); }
    std::string bytes_;
};

/// Beyond the end it reads zeros and remembers that it did.
class Reader {
  public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    template <class T>
    requires std::integral<T> || std::floating_point<T>
    void operator()(T& value) {
        value = {};
        copy(&value, 1, sizeof value);
    }
    void operator()(std::string& text) {
        text.resize(length(1));
        copy(text.data(), text.size(), 1);
    }
    template <class T>
    void operator()(std::vector<T>& items) {
        items.resize(length(sizeof(T)));
        copy(items.data(), items.size(), sizeof(T));
    }
    /// Every byte was read, and no more.
    bool is_done() const { return !failed_ && bytes_.empty(); }

  private:
    /// Of a list whose items are all there; else 0.
    std::size_t length(std::size_t item_bytes) {
        std::uint64_t count = 0;
        (*this)(count);
        if (count <= bytes_.size() / item_bytes) return static_cast<std::size_t>(count);
        failed_ = true;
        return 0;
    }
    void copy(void* to, std::size_t count, std::size_t item_bytes) {
        if (count > bytes_.size() / item_bytes) {
            failed_ = true;
            return;
        }
        if (count == 0) return;
        std::memcpy(to, bytes_.data(), count * item_bytes);
        bytes_.remove_prefix(count * item_bytes);
    }

    std::string_view bytes_;
    bool failed_ = false;
};

/// What must be the same on both sides for the bytes of the lists to mean the same.
struct Layout {
    std::uint64_t hash = 0;
    std::uint32_t ray = 0, hit = 0, shadow_ray = 0, chunk = 0;
    bool operator==(const Layout&) const = default;
};

Layout own_layout() {
    const auto& files = embedded_kernels();
    const auto layout = std::ranges::find(files, "layout.h", &KernelFile::name);
    return {layout_hash(layout->text), sizeof(Ray), sizeof(Hit), sizeof(ShadowRay), CHUNK};
}

template <class Archive>
void layout_fields(Archive& archive, Layout& layout) {
    archive(layout.hash);
    for (std::uint32_t* bytes : {&layout.ray, &layout.hit, &layout.shadow_ray, &layout.chunk}) archive(*bytes);
}

template <class Archive>
void planes_field(Archive& archive, FilmPlanes& planes) {
    std::uint32_t kept = 0;
    for (int plane = 0; plane < FILM_PLANES; ++plane)
        if (planes.keeps(plane)) kept |= 1u << plane;
    archive(kept);
    for (int plane = 0; plane < FILM_PLANES; ++plane)
        if (kept >> plane & 1u) planes.keep(plane);
}

/// The one list of what is in a file, for writing and reading alike.
template <class Archive>
void fields(Archive& archive, Capture& c) {
    const auto each = [&](auto&... field) { (archive(field), ...); };
    each(c.frame.scene_file, c.frame.scene_hash, c.frame.width, c.frame.height, c.frame.spp, c.frame.depth,
         c.frame.seed);
    each(c.frame.crop.x0, c.frame.crop.x1, c.frame.crop.y0, c.frame.crop.y1);
    planes_field(archive, c.frame.planes);
    auto stage = static_cast<std::uint8_t>(c.stage);
    archive(stage);
    c.stage = static_cast<profile::Stage>(stage);
    each(c.depth, c.launch, c.count, c.first_sample, c.slots.first, c.slots.count);
    each(c.rays, c.hits, c.shadow_rays, c.shadow_counts);
    each(c.digest.queue, c.digest.film);
}

template <class Number>
Number number_at(std::string_view bytes, std::size_t place) {
    Number number{};
    std::memcpy(&number, bytes.data() + place, sizeof number);
    return number;
}

[[noreturn]] void refuse(const std::string& file, const std::string& reason) {
    throw UsageError(fmt::format("{}: {}", file, reason));
}

/// What follows a sound header.
std::string_view payload_of(const std::string& file, std::string_view bytes) {
    if (bytes.substr(0, magic.size()) != magic.substr(0, std::min(magic.size(), bytes.size())) || bytes.empty())
        refuse(file, "this is no captured queue; `raymill render SCENE --capture 0,intersect,FILE` writes one");
    if (bytes.size() >= size_at) {
        const auto version = number_at<std::uint32_t>(bytes, version_at);
        if (version != format_version)
            refuse(file, fmt::format("the captured queue has version {}, and this program reads version {}: capture it "
                                     "again",
                                     version, format_version));
    }
    const std::uint64_t there = bytes.size() - std::min(bytes.size(), payload_at);
    const std::uint64_t expected = bytes.size() >= payload_at ? number_at<std::uint64_t>(bytes, size_at) : 1;
    if (there != expected)
        refuse(file, fmt::format("the captured queue is {}: capture it again",
                                 there < expected ? "cut off" : "followed by something else"));
    const std::string_view payload = bytes.substr(payload_at);
    if (fnv1a(payload) != number_at<std::uint64_t>(bytes, checksum_at))
        refuse(file, "the captured queue is damaged (its checksum is wrong): capture it again");
    return payload;
}

}  // namespace

std::uint64_t layout_hash(std::string_view layout) {
    std::string text;
    for (std::size_t i = 0; i < layout.size(); ++i) {
        if (layout.substr(i, 2) == "//") i = std::min(layout.find('\n', i), layout.size());
        if (i < layout.size() && !std::isspace(static_cast<unsigned char>(layout[i]))) text += layout[i];
    }
    return fnv1a(text);
}

void write_capture(const std::string& file, const Capture& capture) {
    Writer payload;
    Layout layout = own_layout();
    layout_fields(payload, layout);
    Capture copy = capture;  // the list of fields serves readers as well, so it takes what may change
    fields(payload, copy);

    std::uint32_t version = format_version;
    std::uint64_t size = payload.bytes().size(), checksum = fnv1a(payload.bytes());
    Writer header;
    header(version);
    header(size);
    header(checksum);
    write_text_atomically(file, [&](std::ostream& out) { out << magic << header.bytes() << payload.bytes(); });
}

Capture read_capture(const std::string& file) {
    std::string reason;
    const std::optional<std::string> bytes = InputFiles().read(file, reason);
    if (!bytes) refuse(file, fmt::format("cannot read the captured queue: {}", reason));
    Reader reader(payload_of(file, *bytes));
    Layout layout;
    layout_fields(reader, layout);
    if (layout != own_layout())
        refuse(file, "the captured queue has another layout (kernels/layout.h has changed since): capture it again");
    Capture capture;
    fields(reader, capture);
    if (!reader.is_done()) refuse(file, "the captured queue is damaged (its lists do not fill it): capture it again");
    return capture;
}

}  // namespace raymill::capture
