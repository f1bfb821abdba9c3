#include "scene/gltf_uri.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <stdexcept>

namespace raymill {
namespace {

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string decode_base64(std::string_view text) {
    while (text.ends_with('=')) text.remove_suffix(1);
    std::array<int, 256> value_of;
    value_of.fill(-1);
    for (std::size_t i = 0; i < base64_digits.size(); ++i)
        value_of[static_cast<unsigned char>(base64_digits[i])] = static_cast<int>(i);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int value = value_of[static_cast<unsigned char>(c)];
        if (value < 0) throw std::runtime_error("its data is not base64");
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 0xff);
    }
    if (text.size() % 4 == 1) throw std::runtime_error("its base64 data is cut off");
    return bytes;
}

std::string decode_percent(std::string_view text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned char code = 0;
        const std::string_view digits = text.substr(i + 1, 2);
        const char* end = digits.data() + digits.size();
        if (text[i] == '%' && digits.size() == 2 && std::from_chars(digits.data(), end, code, 16).ptr == end) {
            decoded += static_cast<char>(code);
            i += 2;
        } else {
            decoded += text[i];
        }
    }
    return decoded;
}

}  // namespace

std::optional<std::string> decode_data_uri(const std::string& uri) {
    if (!uri.starts_with("data:")) return std::nullopt;
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos) throw std::runtime_error("its data: URI has no comma before the data");
    const std::string_view kind = std::string_view(uri).substr(5, comma - 5);
    const std::string_view data = std::string_view(uri).substr(comma + 1);
    return kind.ends_with(";base64") ? decode_base64(data) : decode_percent(data);
}

std::string path_of_uri(const std::string& uri) {
    const std::size_t colon = uri.find(':');
    if (colon != std::string::npos && colon < uri.find_first_of("/?#"))
        throw std::runtime_error(
            fmt::format("its URI is \"{}\", but only data: and files are read", uri.substr(0, 60)));
    return decode_percent(uri);
}

}  // namespace raymill
