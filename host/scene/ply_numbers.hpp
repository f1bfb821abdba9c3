// The numbers of a PLY body, one after the other, ascii or binary.
#pragma once

#include "scene/ply_header.hpp"

namespace raymill {

class PlyNumbers {
  public:
    /// The views must outlive this object.
    PlyNumbers(std::string_view bytes, const PlyHeader& header, const std::string& file);

    /// Throws SceneError at the end of the file, or where an ascii body has no number.
    double next(PlyType type);
    /// The least bytes that one number takes.
    std::size_t least_bytes(PlyType type) const { return binary_ ? size_of(type) : 2; }
    std::size_t bytes_left() const { return bytes_.size() - at_ + (binary_ ? 0 : 1); }  // a last blank may lack
    /// Throws if anything but blanks and zero bytes is left.
    void expect_end();
    /// Names the current line (ascii) or, in the message, the byte (binary).
    [[noreturn]] void fail(const std::string& message) const;

  private:
    double next_binary(PlyType type);
    double next_word();

    std::string_view bytes_;
    const std::string& file_;
    std::size_t at_;
    int line_;
    bool binary_, swap_;
};

}  // namespace raymill
