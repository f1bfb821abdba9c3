#include "scene/ply_header.hpp"

#include <fmt/format.h>

#include <charconv>

#include "scene/error.hpp"

namespace raymill {
namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr TypeName type_names[] = {
    {"char", PlyType::int8},       {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},     {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},   {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},     {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},   {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64},
};

std::string_view next_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    line.remove_prefix(word.size());
    return word;
}

class HeaderReader {
  public:
    HeaderReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    PlyHeader read() {
        std::string_view magic = take_line();
        if (next_word(magic) != "ply") fail("a PLY file begins with the line \"ply\"");
        bool has_format = false;
        for (;;) {
            if (at_ >= bytes_.size()) fail("the file ends before the line \"end_header\"");
            std::string_view line = take_line();
            const std::string_view keyword = next_word(line);
            if (keyword == "end_header") break;
            if (keyword == "format")
                read_format(line), has_format = true;
            else if (keyword == "element")
                read_element(line);
            else if (keyword == "property")
                read_property(line);
            else if (keyword == "comment")
                read_comment(line);
            else if (!keyword.empty() && keyword != "obj_info")
                fail(fmt::format("\"{}\" is not a keyword of a PLY header", printable(keyword)));
        }
        if (!has_format) fail("the header has no line \"format\"");
        header_.body = at_;
        header_.body_line = line_ + 1;
        return std::move(header_);
    }

  private:
    [[noreturn]] void fail(const std::string& message) const { throw SceneError({file_, line_, 0}, message); }

    std::string_view take_line() {
        ++line_;
        const std::size_t end = std::min(bytes_.find_first_of("\n\r", at_), bytes_.size());
        const std::string_view line = bytes_.substr(at_, end - at_);
        at_ = std::min(end + (bytes_.substr(end).starts_with("\r\n") ? 2 : 1), bytes_.size());
        return line;
    }

    void read_format(std::string_view line) {
        const std::string_view format = next_word(line), version = next_word(line);
        if (format == "ascii")
            header_.format = PlyFormat::ascii;
        else if (format == "binary_little_endian")
            header_.format = PlyFormat::binary_little_endian;
        else if (format == "binary_big_endian")
            header_.format = PlyFormat::binary_big_endian;
        else
            fail(fmt::format("\"{}\" is none of the formats ascii, binary_little_endian and binary_big_endian",
                             printable(format)));
        if (version != "1.0") fail(fmt::format("\"{}\" is not the version 1.0 that is read", printable(version)));
    }

    void read_element(std::string_view line) {
        PlyElement element;
        element.name = next_word(line);
        element.line = line_;
        const std::string_view count = next_word(line);
        const auto [end, fault] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (element.name.empty() || fault != std::errc() || end != count.data() + count.size())
            fail(fmt::format("an element needs a name and a count, not \"{}\"", printable(count)));
        for (const PlyElement& other : header_.elements)
            if (other.name == element.name)
                fail(fmt::format("there is a second element \"{}\"", printable(element.name)));
        header_.elements.push_back(std::move(element));
    }

    PlyType read_type(std::string_view word) const {
        for (const auto& [name, type] : type_names)
            if (name == word) return type;
        fail(fmt::format("\"{}\" is not a type of PLY", printable(word)));
    }

    void read_property(std::string_view line) {
        if (header_.elements.empty()) fail("a property before the first element");
        PlyProperty property;
        std::string_view type = next_word(line);
        property.is_list = type == "list";
        if (property.is_list) {
            property.count_type = read_type(next_word(line));
            if (property.count_type == PlyType::float32 || property.count_type == PlyType::float64)
                fail("the length of a list must be of a whole type");
            type = next_word(line);
        }
        property.type = read_type(type);
        property.name = next_word(line);
        if (property.name.empty()) fail("a property needs a type and a name");
        header_.elements.back().properties.push_back(std::move(property));
    }

    void read_comment(std::string_view line) {
        if (next_word(line) != "TextureFile") return;
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        const std::size_t last = line.find_last_not_of(" \t");
        if (last != std::string_view::npos) header_.textures.emplace_back(line.substr(0, last + 1));
    }

    std::string_view bytes_;
    const std::string& file_;
    PlyHeader header_;
    std::size_t at_ = 0;
    int line_ = 0;
};

}  // namespace

std::string printable(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, 40)) text += c > ' ' && c < 0x7f ? c : '?';
    return text;
}

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::float64:
            return 8;
        default:
            return 4;
    }
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& file) {
    return HeaderReader(bytes, file).read();
}

}  // namespace raymill
