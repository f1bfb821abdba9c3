// The header of a PLY file: which elements its body holds, and how their numbers are written.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raymill {

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of one number in a binary body.
std::size_t size_of(PlyType type);

/// The beginning of a word as it can be shown: binary data may stand where text should.
std::string printable(std::string_view word);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    bool is_list = false;
    PlyType count_type = PlyType::uint8;  // of a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
    int line = 0;  // where the header declares it
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> textures;  // of MeshLab's "comment TextureFile NAME"
    std::size_t body = 0;               // offset of the first byte after the header
    int body_line = 1;
};

/// Lines may end with LF, CR LF or CR. Throws SceneError with the line for what is not a PLY header of version 1.0.
/// Source: Turk, "The PLY Polygon File Format", 1994.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file);

}  // namespace raymill
