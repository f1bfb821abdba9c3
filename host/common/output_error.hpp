// How a failed write is worded.
#pragma once

#include <string>

#include "common/error.hpp"

namespace raymill {

/// "Cannot write FILE: reason; what to do."
OutputError write_error(const std::string& file, const std::string& reason);

/// The same for a value of errno, with the advice that fits it.
OutputError write_error(const std::string& file, int error_number);

}  // namespace raymill
