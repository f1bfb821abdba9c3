// glTF's URIs: data within them, and names of files.
#pragma once

#include <optional>
#include <string>

namespace raymill {

/// The bytes of a "data:" URI (RFC 2397), base64 or percent-encoded. Throws std::runtime_error with the reason where it
/// is damaged; nothing for another URI.
std::optional<std::string> decode_data_uri(const std::string& uri);

/// The path that a relative URI (RFC 3986) names, without percent encoding. Throws std::runtime_error for one with a
/// scheme, such as "http:".
std::string path_of_uri(const std::string& uri);

}  // namespace raymill
