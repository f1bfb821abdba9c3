// Numbers as text files of meshes spell them.
#pragma once

#include <string_view>

namespace raymill {

/// Reads the whole word as a number: C's forms, "nan" and "inf" among them, a leading "+", and MSVC's "1.#INF" and
/// "1.#IND". False where the word is no number.
bool parse_number(std::string_view word, double& value);

}  // namespace raymill
