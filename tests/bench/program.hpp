// What programs that measure do around their measurement: arguments, and what becomes of errors.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <functional>
#include <string>

#include "common/error.hpp"
#include "scene/error.hpp"

namespace raymill::bench {

inline constexpr int failed = 1;
inline constexpr int bad_input = 2;

/// Parses the arguments and measures; returns the exit status. measure: whether all is well. Errors go to standard
/// error behind the program's name.
inline int run_program(const std::string& name, CLI::App& app, int argc, char** argv,
                       const std::function<bool()>& measure) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : bad_input;
    }
    const auto fail = [&](int status, const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", name, error.what());
        return status;
    };
    try {
        // As raymill does: workers that stay where they are. It must be set before OpenCL is loaded.
        setenv("POCL_AFFINITY", "1", 0);
        return measure() ? 0 : failed;
    } catch (const SceneError& error) {
        return fail(bad_input, error);
    } catch (const UsageError& error) {
        return fail(bad_input, error);
    } catch (const std::exception& error) {
        return fail(failed, error);
    }
}

}  // namespace raymill::bench
