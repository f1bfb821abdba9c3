// Files that appear whole or not at all.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

namespace raymill {

/// Calls write(temporary path) and renames the result to `file`. The temporary is an empty file in the same folder; if
/// anything fails it is removed, and a `file` that was there before stays as it was. Symbolic links are followed, and
/// an existing file keeps its permissions. What is not a regular file (a pipe, /dev/stdout) receives the bytes instead.
/// Throws OutputError with what failed and why; what `write` throws passes through.
void write_atomically(const std::string& file, const std::function<void(const std::string& temporary)>& write);

/// The same for text that `write` puts into a stream.
void write_text_atomically(const std::string& file, const std::function<void(std::ostream& out)>& write);

/// Throws OutputError if `file` could not be created (folder missing, no permission), without touching it.
void check_writable(const std::string& file);

}  // namespace raymill
