#include "scene/gltf_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "scene/gltf_uri.hpp"

namespace raymill {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF's binary data is little-endian");

constexpr int type_byte = 5120, type_unsigned_byte = 5121, type_short = 5122, type_unsigned_short = 5123,
              type_unsigned_int = 5125, type_float = 5126;

/// What the renderer reads, or may pass over without showing anything else than it would with it.
constexpr std::string_view extensions_read[] = {"KHR_lights_punctual",
                                                "KHR_materials_emissive_strength",
                                                "KHR_materials_ior",
                                                "KHR_materials_specular",
                                                "KHR_materials_pbrSpecularGlossiness",
                                                "KHR_materials_transmission",
                                                "KHR_materials_unlit",
                                                "KHR_materials_volume",
                                                "KHR_mesh_quantization",
                                                "KHR_texture_transform"};

bool is_read(const std::string& extension) {
    return std::find(std::begin(extensions_read), std::end(extensions_read), extension) != std::end(extensions_read);
}

/// Bytes, or 0 for an unknown type.
std::size_t size_of_component(int type) {
    switch (type) {
        case type_byte:
        case type_unsigned_byte:
            return 1;
        case type_short:
        case type_unsigned_short:
            return 2;
        case type_unsigned_int:
        case type_float:
            return 4;
        default:
            return 0;
    }
}

template <class T>
T loaded(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// A component; normalised ones by the rules of section 3.11.
double component(const char* bytes, int type, bool normalized) {
    switch (type) {
        case type_byte:
            return normalized ? std::max(loaded<std::int8_t>(bytes) / 127.0, -1.0) : loaded<std::int8_t>(bytes);
        case type_unsigned_byte:
            return loaded<std::uint8_t>(bytes) / (normalized ? 255.0 : 1.0);
        case type_short:
            return normalized ? std::max(loaded<std::int16_t>(bytes) / 32767.0, -1.0) : loaded<std::int16_t>(bytes);
        case type_unsigned_short:
            return loaded<std::uint16_t>(bytes) / (normalized ? 65535.0 : 1.0);
        case type_unsigned_int:
            return loaded<std::uint32_t>(bytes);
        default:
            return double{loaded<float>(bytes)};
    }
}

/// Rows and columns of an element.
struct Shape {
    std::size_t rows, columns;
};

Shape shape_of(const GltfValue& accessor) {
    const std::string type = accessor.at("type").text();
    if (type == "SCALAR") return {1, 1};
    const auto size = static_cast<std::size_t>(type.empty() ? 0 : type.back() - '0');
    if (type == "VEC2" || type == "VEC3" || type == "VEC4") return {size, 1};
    if (type == "MAT2" || type == "MAT3" || type == "MAT4") return {size, size};
    accessor.at("type").fail(fmt::format("is \"{}\", which is no type of glTF", type));
}

}  // namespace

std::size_t gltf_component_size(const GltfValue& accessor) {
    const GltfValue type = accessor.at("componentType");
    const std::size_t size = size_of_component(static_cast<int>(type.whole(1 << 20)));
    if (size == 0) type.fail(fmt::format("is {}, which is no componentType of glTF", type.whole()));
    return size;
}

std::size_t gltf_element_size(const GltfValue& accessor) {
    const auto [rows, columns] = shape_of(accessor);
    const std::size_t column = rows * gltf_component_size(accessor);
    return columns == 1 ? column : columns * ((column + 3) / 4 * 4);
}

GltfFile::GltfFile(Loading& loading, const std::string& path, std::string bytes) : loading_(loading), path_(path) {
    parse(open_container(bytes));
    const GltfValue root = this->root();
    const GltfValue asset = root.at("asset");
    const std::string version = asset.at("version").text();
    if (!version.starts_with("2.") || asset.text_or("minVersion", "2.0") > "2.0")
        asset.fail(fmt::format("is of version \"{}\": glTF 2.0 is read",
                               version.starts_with("2.") ? asset.text_or("minVersion", "2.0") : version));
    std::vector<std::string> unknown;
    if (const auto required = root.find("extensionsRequired"))
        for (const GltfValue& name : required->items())
            if (!is_read(name.text())) unknown.push_back(name.text());
    if (!unknown.empty())
        throw SceneError(
            {path_},
            fmt::format("the file cannot be shown without the extension{} {}, which {} not supported",
                        unknown.size() == 1 ? "" : "s", fmt::join(unknown, ", "), unknown.size() == 1 ? "is" : "are"));
    check_gltf_document(root);
    load_buffers();
    if (const auto used = root.find("extensionsUsed"))
        for (const GltfValue& name : used->items())
            if (!is_read(name.text())) leave_out(name.text());
}

void GltfFile::warn_of_left_out() {
    if (!left_out_.empty())
        loading_.warn({path_}, fmt::format("not supported and left out: {}", fmt::join(left_out_, ", ")));
}

/// The JSON text: all of a .gltf, or the first chunk of a GLB, whose second one is kept.
std::string_view GltfFile::open_container(const std::string& bytes) {
    if (!bytes.starts_with("glTF")) {
        if (extension_of(path_) == ".glb") throw SceneError({path_}, "a GLB file begins with the letters \"glTF\"");
        return bytes;
    }
    constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;
    const auto cut_off = [&] { return SceneError({path_}, "the file is cut off: it is shorter than its header says"); };
    if (bytes.size() < 12) throw cut_off();
    const auto version = loaded<std::uint32_t>(&bytes[4]), length = loaded<std::uint32_t>(&bytes[8]);
    if (version != 2)
        throw SceneError({path_}, fmt::format("the file is GLB of version {}: version 2 is read", version));
    if (length > bytes.size()) throw cut_off();
    if (length < bytes.size())
        throw SceneError({path_}, fmt::format("the header says {} bytes, but the file has {}", length, bytes.size()));
    std::string_view json;
    std::size_t chunks = 0;
    for (std::size_t at = 12; at < length; ++chunks) {
        if (length - at < 8) throw cut_off();
        const auto size = loaded<std::uint32_t>(&bytes[at]), type = loaded<std::uint32_t>(&bytes[at + 4]);
        at += 8;
        if (size > length - at) throw cut_off();
        if ((type == json_chunk) != (chunks == 0) || (type == bin_chunk && chunks != 1))
            throw SceneError({path_}, "the chunks of a GLB file are first JSON, then at most one of binary data");
        if (type == json_chunk) json = std::string_view(bytes).substr(at, size);
        if (type == bin_chunk) binary_chunk_ = bytes.substr(at, size);
        at += size;
    }
    return json;
}

void GltfFile::parse(std::string_view text) {
    try {
        document_ = nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& fault) {
        const std::string_view before = text.substr(0, std::min(text.size(), fault.byte));
        const auto line = static_cast<int>(std::count(before.begin(), before.end(), '\n')) + 1;
        const std::size_t line_start = before.rfind('\n') + 1;  // 0 on the first line
        const bool ended = before.size() >= text.size();
        throw SceneError({path_, line, static_cast<int>(std::max<std::size_t>(before.size() - line_start, 1))},
                         ended ? "the JSON text is not complete" : "this is not JSON");
    } catch (const nlohmann::json::exception&) {  // a number beyond a double
        throw SceneError({path_}, "a number of the JSON text is too large");
    }
    if (!document_.is_object()) throw SceneError({path_}, "the JSON text must be an object");
}

GltfValue GltfFile::referred(const GltfValue& reference, const std::string& collection) const {
    return root().at(collection).item(reference.whole());
}

void GltfFile::load_buffers() {
    const std::optional<GltfValue> buffers = root().find("buffers");
    const std::size_t count = buffers ? buffers->items().size() : 0;
    for (std::size_t i = 0; i < count; ++i) {
        const GltfValue value = buffers->item(i);
        const std::string uri = value.text_or("uri", "");
        if (uri.empty() && !(i == 0 && binary_chunk_)) continue;  // an extension may provide it, or nothing use it
        std::string bytes;
        try {
            bytes = uri.empty() ? std::move(*binary_chunk_) : read_uri(uri);
        } catch (const std::runtime_error& fault) {
            value.fail(fmt::format("cannot be read: {}", fault.what()));
        }
        const std::uint64_t length = value.at("byteLength").whole();
        if (bytes.size() < length)
            value.fail(fmt::format("must have {} bytes, but there are {}", length, bytes.size()));
        bytes.resize(length);
        buffers_.emplace(i, std::move(bytes));
    }
}

std::string GltfFile::read_uri(const std::string& uri) {
    if (std::optional<std::string> data = decode_data_uri(uri)) return std::move(*data);
    std::string reason;
    std::optional<std::string> bytes = loading_.files.read(path_beside(path_, path_of_uri(uri)), reason);
    if (!bytes) throw std::runtime_error(fmt::format("\"{}\": {}", uri, reason));
    return std::move(*bytes);
}

GltfFile::View GltfFile::buffer_view(const GltfValue& reference) const {
    const GltfValue value = referred(reference, "bufferViews");
    const auto buffer = buffers_.find(value.at("buffer").whole());
    if (buffer == buffers_.end()) value.at("buffer").fail("refers to a buffer without data");
    return {std::string_view(buffer->second).substr(value.whole_or("byteOffset", 0), value.at("byteLength").whole()),
            value.whole_or("byteStride", 0)};
}

GltfNumbers GltfFile::accessor(const GltfValue& reference, std::span<const char* const> types,
                               std::span<const int> component_types) {
    const GltfValue value = referred(reference, "accessors");
    const std::string type = value.at("type").text();
    if (std::none_of(types.begin(), types.end(), [&](const char* allowed) { return type == allowed; }))
        value.fail(
            fmt::format("has the type \"{}\", but {} needs {}", type, reference.path(), fmt::join(types, " or ")));
    const auto component_type = static_cast<int>(value.at("componentType").whole(1 << 20));
    const bool allowed = component_types.empty() || std::find(component_types.begin(), component_types.end(),
                                                              component_type) != component_types.end();
    if (!allowed)
        value.fail(fmt::format("has the componentType {}, which does not serve {}", component_type, reference.path()));
    const std::optional<GltfValue> normalized_flag = value.find("normalized");
    const bool normalized = normalized_flag && normalized_flag->flag();

    GltfNumbers numbers{value.at("count").whole(NO_INDEX - 1), shape_of(value).rows, {}};
    const std::optional<GltfValue> view_reference = value.find("bufferView");
    if (view_reference) {
        read_dense(value, *view_reference, component_type, normalized, numbers);
    } else {
        constexpr std::size_t most_zeros = 1 << 22;  // no file vouches for their number
        if (numbers.count > most_zeros) value.fail(fmt::format("has no data, and more than {} elements", most_zeros));
        numbers.values.resize(numbers.count * numbers.components);
    }
    if (const auto sparse = value.find("sparse")) read_sparse(*sparse, component_type, normalized, numbers);
    for (const double number : numbers.values)
        if (!std::isfinite(number)) value.fail("has numbers that are not finite");
    return numbers;
}

void GltfFile::read_dense(const GltfValue& accessor, const GltfValue& view_reference, int component_type,
                          bool normalized, GltfNumbers& numbers) {
    const View view = buffer_view(view_reference);
    const std::size_t size = size_of_component(component_type);
    const std::size_t stride = view.stride > 0 ? view.stride : size * numbers.components;
    const std::uint64_t offset = accessor.whole_or("byteOffset", 0);  // check_gltf_document has seen that all is there
    numbers.values.reserve(numbers.count * numbers.components);
    for (std::size_t i = 0; i < numbers.count; ++i)
        for (std::size_t c = 0; c < numbers.components; ++c)
            numbers.values.push_back(
                component(view.bytes.data() + offset + i * stride + c * size, component_type, normalized));
}

void GltfFile::read_sparse(const GltfValue& sparse, int component_type, bool normalized, GltfNumbers& numbers) {
    GltfNumbers places{sparse.at("count").whole(numbers.count), 1, {}};
    GltfNumbers values{places.count, numbers.components, {}};
    const GltfValue indices = sparse.at("indices"), replaced = sparse.at("values");
    const auto index_type = static_cast<int>(indices.at("componentType").whole(1 << 20));
    if (index_type != type_unsigned_byte && index_type != type_unsigned_short && index_type != type_unsigned_int)
        indices.fail(fmt::format("has the componentType {}, which is none of indices", index_type));
    read_dense(indices, indices.at("bufferView"), index_type, false, places);
    read_dense(replaced, replaced.at("bufferView"), component_type, normalized, values);
    for (std::size_t i = 0; i < places.count; ++i) {
        const double place = places.values[i];
        if (!(place < static_cast<double>(numbers.count)))
            indices.fail(fmt::format("has the index {}, but there are {} elements", place, numbers.count));
        std::copy_n(values[i], numbers.components,
                    &numbers.values[static_cast<std::size_t>(place) * numbers.components]);
    }
}

GltfPicture GltfFile::picture(const GltfValue& image) const {
    const std::string name = fmt::format("{}: {}", path_, image.path());
    if (const auto view = image.find("bufferView")) return {name, std::string(buffer_view(*view).bytes), false};
    const std::string uri = image.at("uri").text();
    try {
        if (std::optional<std::string> data = decode_data_uri(uri)) return {name, std::move(*data), false};
        return {path_beside(path_, path_of_uri(uri)), {}, true};
    } catch (const std::runtime_error& fault) {
        image.fail(fmt::format("cannot be read: {}", fault.what()));
    }
}

}  // namespace raymill
