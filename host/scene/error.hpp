// The exceptions a user may meet: each carries one sentence that says what was wrong, where, and what to do.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "common/error.hpp"

namespace raymill {

/// Where something stands in a text file. line and column count from 1; 0 means unknown.
struct SourcePosition {
    std::string file;
    int line = 0;
    int column = 0;
};

/// "file:line:column" as far as known.
std::string to_string(const SourcePosition& position);

/// A warning or an error with its place.
struct Diagnostic {
    SourcePosition position;
    std::string message;
};

/// "file:line:column: message".
std::string to_string(const Diagnostic& diagnostic);

/// Bad input: one or more faults of a scene or of a file it names. Exit status 2.
/// what() holds one line a fault, at most 20, then how many more there are.
class SceneError : public std::runtime_error {
  public:
    explicit SceneError(std::vector<Diagnostic> diagnostics);
    SceneError(SourcePosition position, std::string message);
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

  private:
    std::vector<Diagnostic> diagnostics_;
};

}  // namespace raymill
