// How a failed write is worded.
#include "common/output_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

namespace raymill {

OutputError write_error(const std::string& file, const std::string& reason) {
    return OutputError(fmt::format("Cannot write '{}': {}.", file, reason));
}

OutputError write_error(const std::string& file, int error_number) {
    const char* advice = "choose another output file";
    if (error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG)
        advice = "free some space or choose a file on another disk";
    if (error_number == EACCES || error_number == EPERM) advice = "change the permissions or choose another folder";
    return write_error(file, fmt::format("{}; {}", std::generic_category().message(error_number), advice));
}

}  // namespace raymill
