#include "cli/frame_captures.hpp"

#include <fmt/format.h>

#include "capture/capture_file.hpp"
#include "common/error.hpp"

namespace raymill {

using profile::stage_name;

FrameCaptures::FrameCaptures(const std::vector<std::string>& arguments) {
    for (const std::string& argument : arguments) requests_.push_back(capture::parse_request(argument));
}

std::vector<std::string> FrameCaptures::files() const {
    std::vector<std::string> files;
    for (const capture::Request& request : requests_) files.push_back(request.file);
    return files;
}

void FrameCaptures::check(const Scene& scene) const {
    for (const capture::Request& request : requests_) {
        const int deepest = scene.settings.depth - (request.stage == profile::Stage::secondary ? 1 : 0);
        if (request.depth > deepest)
            throw UsageError(
                fmt::format("--capture {},{}: with a recursion limit of {}, {} {}", request.depth,
                            stage_name(request.stage), scene.settings.depth, stage_name(request.stage),
                            deepest >= 0 ? fmt::format("works on depths 0 to {}", deepest) : "never runs"));
    }
}

void FrameCaptures::observe(const Device& device, Renderer& renderer) {
    if (requests_.empty()) return;
    for (const capture::Request& request : requests_) recorders_.emplace_back(device, request);
    renderer.observe([this](const char* stage, const WaveView& view) {
        for (capture::Recorder& recorder : recorders_) recorder.see(stage, view);
    });
}

void FrameCaptures::write(const Scene& scene, Renderer& renderer, const Frame& frame, bool quiet) {
    renderer.observe({});
    for (capture::Recorder& recorder : recorders_) {
        const capture::Request& request = recorder.request();
        const auto found = recorder.finish(scene, renderer, frame.planes);
        if (found) {
            capture::write_capture(request.file, *found);
            if (!quiet)
                fmt::print(stderr, "{}: launch {} of {} at depth {}, of {}, {} items\n", request.file, found->launch,
                           stage_name(found->stage), found->depth, recorder.launches(), found->items());
            continue;
        }
        const std::string message = fmt::format(
            "--capture {},{}: this frame has no {} of {} at depth {}{}", request.depth, stage_name(request.stage),
            request.launch ? fmt::format("launch {}", *request.launch) : std::string("launch"),
            stage_name(request.stage), request.depth,
            recorder.launches() > 0 ? fmt::format(", the last is {}", recorder.launches() - 1) : "");
        if (frame.finished == 1) throw UsageError(message);
        fmt::print(stderr, "interrupted: {}\n", message);
    }
}

}  // namespace raymill
