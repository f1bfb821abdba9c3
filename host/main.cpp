// Parses the command line, runs one command, and turns what goes wrong into a sentence and an exit status.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "cli/commands.hpp"
#include "common/error.hpp"
#include "device/device.hpp"
#include "scene/error.hpp"

namespace {

constexpr int render_failed = 1;
constexpr int bad_input = 2;

/// What was printed must have arrived: a scene file cut off by a full disk is no success.
void check_standard_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
        throw raymill::OutputError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
}

int run(int argc, char** argv) {
    using namespace raymill;
    CLI::App app("Raymill renders scenes by moving rays through queues on an OpenCL device.", "raymill");
    app.set_version_flag("--version", "raymill " RAYMILL_VERSION);
    app.require_subcommand(1);
    app.footer(
        "`raymill COMMAND --help` tells more. Start with: raymill render scenes/first-light.toml -o first-light.png");
    const std::pair<const char*, Command> commands[] = {
        {"render", add_render_command(app)},   {"profile", add_profile_command(app)},
        {"check", add_check_command(app)},     {"devices", add_devices_command(app)},
        {"explain", add_explain_command(app)}, {"verify", add_verify_command(app)},
        {"replay", add_replay_command(app)},   {"scene", add_scene_command(app)},
        {"compile", add_compile_command(app)}};
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        const bool unknown_command = app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-';
        if (unknown_command) throw UsageError(fmt::format("there is no command \"{}\"; see raymill --help", argv[1]));
        throw UsageError(fmt::format("{}; see raymill --help", error.what()));
    }
    for (const auto& [name, command] : commands)
        if (app.got_subcommand(name)) {
            const int status = command();
            check_standard_output();
            return status;
        }
    return bad_input;
}

int fail(int status, const char* message) {
    fmt::print(stderr, "raymill: {}\n", message);
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    // PoCL's workers are woken faster, and never two on one core, when each stays on its own.
    setenv("POCL_AFFINITY", "1", 0);
    try {
        return run(argc, argv);
    } catch (const raymill::SceneError& error) {
        return fail(bad_input, error.what());
    } catch (const raymill::UsageError& error) {
        return fail(bad_input, error.what());
    } catch (const std::bad_alloc&) {
        return fail(render_failed, "out of memory: render a smaller image or a smaller scene");
    } catch (const std::exception& error) {
        return fail(render_failed, error.what());
    }
}
