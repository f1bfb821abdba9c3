// A copy of the kernels with one change: for tests of what must notice it, and of what must not.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "image/temporary_folder.hpp"

namespace raymill {

/// Copies the kernels to `folder`, which must not be there yet, and puts `wrong` in the place of the first `right` of a
/// file. Fails the test where there is none: see HasFatalFailure().
inline void change_kernels(const std::filesystem::path& folder, const std::string& file, const std::string& right,
                           const std::string& wrong) {
    std::filesystem::copy(RAYMILL_SOURCE_DIR "/kernels", folder, std::filesystem::copy_options::recursive);
    std::string text = read_bytes(folder / file);
    const std::size_t place = text.find(right);
    ASSERT_NE(place, std::string::npos) << file << " no longer contains: " << right;
    write_text(folder / file, text.replace(place, right.size(), wrong));
}

}  // namespace raymill
