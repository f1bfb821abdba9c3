#include "scene/ply_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "scene/error.hpp"
#include "scene/number_text.hpp"

namespace raymill {
namespace {

template <class T>
double value_of(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

}  // namespace

PlyNumbers::PlyNumbers(std::string_view bytes, const PlyHeader& header, const std::string& file)
    : bytes_(bytes),
      file_(file),
      at_(header.body),
      line_(header.body_line),
      binary_(header.format != PlyFormat::ascii),
      swap_((header.format == PlyFormat::binary_big_endian) != (std::endian::native == std::endian::big)) {}

void PlyNumbers::fail(const std::string& message) const {
    if (binary_) throw SceneError({file_}, fmt::format("{} (at byte {})", message, at_));
    throw SceneError({file_, line_, 0}, message);
}

double PlyNumbers::next(PlyType type) {
    return binary_ ? next_binary(type) : next_word();
}

double PlyNumbers::next_binary(PlyType type) {
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size) fail("the file ends before all its elements are read");
    unsigned char number[8];
    std::memcpy(number, bytes_.data() + at_, size);
    if (swap_) std::reverse(number, number + size);
    at_ += size;
    switch (type) {
        case PlyType::int8:
            return value_of<std::int8_t>(number);
        case PlyType::uint8:
            return value_of<std::uint8_t>(number);
        case PlyType::int16:
            return value_of<std::int16_t>(number);
        case PlyType::uint16:
            return value_of<std::uint16_t>(number);
        case PlyType::int32:
            return value_of<std::int32_t>(number);
        case PlyType::uint32:
            return value_of<std::uint32_t>(number);
        case PlyType::float32:
            return double{value_of<float>(number)};
        default:
            return value_of<double>(number);
    }
}

double PlyNumbers::next_word() {
    for (; at_ < bytes_.size() && is_blank(bytes_[at_]); ++at_)
        // CR alone ends a line as well as LF and CR LF.
        line_ += bytes_[at_] == '\n' || (bytes_[at_] == '\r' && bytes_.substr(at_ + 1, 1) != "\n");
    if (at_ == bytes_.size()) fail("the file ends before all its elements are read");
    const std::size_t first = at_;
    while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
    const std::string_view word = bytes_.substr(first, at_ - first);
    double value = 0;
    if (!parse_number(word, value)) fail(fmt::format("\"{}\" is not a number", printable(word)));
    return value;
}

void PlyNumbers::expect_end() {
    while (at_ < bytes_.size() && (is_blank(bytes_[at_]) || bytes_[at_] == '\0')) {
        line_ += bytes_[at_] == '\n';
        ++at_;
    }
    if (at_ < bytes_.size())
        fail(fmt::format("all elements are read, but {} bytes are left: the counts of the header do not match",
                         bytes_.size() - at_));
}

}  // namespace raymill
