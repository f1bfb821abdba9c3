#include "captured.hpp"

#include <stdexcept>

namespace raymill::capture {

Written read_written(const Device& device, Stage stage, const WaveView& view) {
    Written written;
    if (stage == Stage::generate) written.rays = view.rays.items.read(device, view.rays.first, view.rays.count);
    if (stage == Stage::secondary)
        written.rays = view.children->items.read(device, view.children->first, view.children->count);
    if (stage == Stage::intersect) written.hits = view.hits.read(device, 0, view.rays.count);
    if (stage == Stage::shade) {
        const std::size_t segments = std::size_t{Stages::chunks(view.rays.count)} * view.slots.count;
        written.shadow_counts = view.shadow_rays.counts.read(device, 0, segments);
        written.shadow_rays =
            pack_segments(view.shadow_rays.rays.read(device, 0, segments * CHUNK), written.shadow_counts);
    }
    return written;
}

Capture capture_of(TestFrame& frame, Stage stage, int depth, std::optional<std::uint64_t> launch, Written* written) {
    Recorder recorder(frame.device, {stage, depth, launch, ""});
    std::vector<Written> of_launches;
    frame.renderer.observe([&](const char* name, const WaveView& view) {
        recorder.see(name, view);
        if (written && name == name_of(stage) && view.batch.depth == depth)
            of_launches.push_back(read_written(frame.device, stage, view));
    });
    const Frame rendered = frame.renderer.render();
    frame.renderer.observe({});
    std::optional<Capture> capture = recorder.finish(frame.scene, frame.renderer, rendered.planes);
    if (!capture) throw std::runtime_error("no such launch");
    if (written) *written = of_launches.at(capture->launch);
    return *capture;
}

}  // namespace raymill::capture
