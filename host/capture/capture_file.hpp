// Captures on disk. Little-endian, without padding:
//   8 bytes  "RAYQUEUE"
//   u32      version of the format
//   u64      bytes of what follows the checksum
//   u64      checksum of these bytes: FNV-1a, 64 bits
//   u64      hash of kernels/layout.h, then u32 bytes of a ray, a hit, a shadow ray, and u32 CHUNK
//   the fields of Capture in the order of capture_file.cpp; text and lists begin with their u64 length
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "capture/capture.hpp"

namespace raymill::capture {

inline constexpr std::uint32_t format_version = 2;

/// The file appears whole or not at all. Throws OutputError.
void write_capture(const std::string& file, const Capture& capture);

/// Throws UsageError with one sentence if the file cannot be read, is no capture, is cut off or damaged, or is of
/// another version or layout. What the capture says has not been compared with its scene yet: see load_capture().
Capture read_capture(const std::string& file);

/// Of the declarations alone: comments and spaces do not count.
std::uint64_t layout_hash(std::string_view layout);

}  // namespace raymill::capture
