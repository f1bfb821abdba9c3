// The subcommands. Each adds itself to the command line and returns what main calls if it was chosen.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace raymill {

/// Runs a command; the exit status. Throws SceneError, UsageError, DeviceError, OutputError.
using Command = std::function<int()>;

Command add_render_command(CLI::App& app);
Command add_profile_command(CLI::App& app);
Command add_check_command(CLI::App& app);
Command add_compile_command(CLI::App& app);
Command add_devices_command(CLI::App& app);
Command add_explain_command(CLI::App& app);
Command add_verify_command(CLI::App& app);
Command add_replay_command(CLI::App& app);
Command add_scene_command(CLI::App& app);

}  // namespace raymill
