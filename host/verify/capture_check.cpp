#include "verify/capture_check.hpp"

#include "capture/replay.hpp"
#include "wavefront/records.hpp"

namespace raymill::verify {

using profile::Stage;

namespace {

/// The shadow stage needs no replay of the launch: each of its items has a film of its own.
Wave shadow_wave(const Device& device, Stages& stages, const DeviceScene& on_device, const capture::Capture& capture) {
    ItemReplay replay(device, stages, on_device);
    const auto places = capture::unpack_segments(capture.shadow_rays, capture.shadow_counts);
    const std::vector<Contribution> arrived = replay.shadow(places, capture.shadow_counts);
    Wave wave;
    wave.depth = capture.depth;
    for (std::size_t segment = 0; segment < capture.shadow_counts.size(); ++segment)
        for (std::size_t k = 0; k < capture.shadow_counts[segment]; ++k) {
            ShadowItem& item = wave.shadow_rays.emplace_back();
            item.ray = places[segment * CHUNK + k];
            item.arrived = arrived[segment * CHUNK + k];
        }
    return wave;
}

/// The queues before and after a run of any other stage.
Wave wave_after(const Device& device, const Scene& scene, Stages& stages, const DeviceScene& on_device,
                const capture::Capture& capture) {
    capture::Replay replay(device, stages, on_device, capture, film_pixels(scene));
    replay.clear();
    replay.run();
    replay.read();  // so that more children than the queue holds are an error
    Wave wave;
    WaveRecorder recorder(device, stages, on_device, [&](const Wave& complete) { wave = complete; });
    const WaveView view = replay.view();
    const std::string stage(profile::stage_name(capture.stage));
    // To the stages behind it, the captured hits are what intersect has just written.
    if (capture.stage == Stage::shade || capture.stage == Stage::secondary) recorder.see("intersect", view);
    recorder.see(stage, view);
    recorder.finish();
    return wave;
}

}  // namespace

StageReport verify_capture(const Device& device, const Scene& scene, Stages& stages, const DeviceScene& on_device,
                           const capture::Capture& capture, const VerifyOptions& options) {
    const Wave wave = capture.stage == Stage::shadow ? shadow_wave(device, stages, on_device, capture)
                                                     : wave_after(device, scene, stages, on_device, capture);
    return verify_stage(scene, wave, capture.stage, capture.slots, options);
}

}  // namespace raymill::verify
