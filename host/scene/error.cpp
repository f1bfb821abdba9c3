#include "scene/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace raymill {
namespace {

constexpr std::size_t shown_at_most = 20;

std::string joined(const std::vector<Diagnostic>& diagnostics) {
    std::string text;
    const std::size_t shown = std::min(diagnostics.size(), shown_at_most);
    for (std::size_t i = 0; i < shown; ++i) {
        if (i > 0) text += '\n';
        text += to_string(diagnostics[i]);
    }
    const std::size_t more = diagnostics.size() - shown;
    if (more > 0) text += fmt::format("\nand {} more error{}", more, more == 1 ? "" : "s");
    return text;
}

}  // namespace

std::string to_string(const SourcePosition& position) {
    std::string text = position.file;
    if (position.line > 0) text += fmt::format(":{}", position.line);
    if (position.line > 0 && position.column > 0) text += fmt::format(":{}", position.column);
    return text;
}

std::string to_string(const Diagnostic& diagnostic) {
    const std::string place = to_string(diagnostic.position);
    return place.empty() ? diagnostic.message : place + ": " + diagnostic.message;
}

SceneError::SceneError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(joined(diagnostics)), diagnostics_(std::move(diagnostics)) {}

SceneError::SceneError(SourcePosition position, std::string message)
    : SceneError(std::vector{Diagnostic{std::move(position), std::move(message)}}) {}

}  // namespace raymill
