// The exceptions that concern the program's arguments and output, for rooms that do not see the scene.
#pragma once

#include <stdexcept>

namespace raymill {

/// Bad arguments on the command line. Exit status 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A file could not be written. Exit status 1.
class OutputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace raymill
