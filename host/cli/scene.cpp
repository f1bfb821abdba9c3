// raymill scene: the scene file that rendering a bare model uses, to start one's own from.
#include <fmt/format.h>

#include <memory>

#include "cli/commands.hpp"
#include "scene/scene.hpp"

namespace raymill {

Command add_scene_command(CLI::App& app) {
    auto model = std::make_shared<std::string>();
    CLI::App& command = *app.add_subcommand("scene", "Print the scene file that rendering a bare model uses");
    command.add_option("MODEL", *model, "Model (.obj, .ply, .gltf, .glb)")->required();
    command.footer("Example:\n  raymill scene model.obj > my-scene.toml");
    return [model] {
        fmt::print("{}", model_scene_toml(*model));
        return 0;
    };
}

}  // namespace raymill
