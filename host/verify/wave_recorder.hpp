// The queues of a frame as plain data, one wave at a time.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "verify/item_replay.hpp"
#include "wavefront/renderer.hpp"

namespace raymill::verify {

/// One shadow ray, and what became of it.
struct ShadowItem {
    ShadowRay ray;
    uint hit = 0;          // index of the wave's ray whose hit sent it
    uint slot = 0;         // light sample: index into the scene's list of them
    Contribution arrived;  // what the shadow stage added for it
};

/// Everything that went through the queues in one wave.
struct Wave {
    int depth = 0;
    bool generated = false;  // its rays are fresh from the camera
    std::vector<Ray> rays;
    std::vector<Hit> hits;                         // one a ray
    std::vector<Contribution> added;               // one a ray: background, ambient, emission, coverage
    std::vector<Contribution> added_by_intersect;  // of that
    std::vector<ShadowItem> shadow_rays;
    std::vector<Ray> children;
    std::vector<std::string> replay_faults;  // where a stage gave other results for an item in another pixel
};

/// Observes a renderer and hands over each wave when it is complete.
class WaveRecorder {
  public:
    using Receiver = std::function<void(const Wave& wave)>;

    /// Becomes the renderer's observer until it is destroyed. The references must outlive it.
    WaveRecorder(const Device& device, Renderer& renderer, Receiver receiver);
    /// Sees what it is shown by see().
    WaveRecorder(const Device& device, Stages& stages, const DeviceScene& scene, Receiver receiver);
    ~WaveRecorder();
    WaveRecorder(const WaveRecorder&) = delete;
    WaveRecorder& operator=(const WaveRecorder&) = delete;

    /// A WaveObserver. A wave begins with its "generate", or else with its "intersect".
    void see(const std::string& stage, const WaveView& view);
    /// Hands over the last wave; call when the frame is done.
    void finish();

  private:
    void begin(const WaveView& view);
    void take_hits(const WaveView& view);
    void take_shadow_rays(const WaveView& view);

    const Device& device_;
    Renderer* renderer_ = nullptr;  // that it observes
    ItemReplay replay_;
    Receiver receiver_;
    std::optional<Wave> wave_;
};

}  // namespace raymill::verify
