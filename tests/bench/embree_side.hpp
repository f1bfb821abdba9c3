// The peer: Embree 3 over the same triangles and spheres, in each of the ways that it offers.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "ray_sets.hpp"
#include "variant.hpp"

namespace raymill::bench {

/// Shares the scene's arrays of triangles: it must outlive this.
class EmbreeSide {
  public:
    /// threads: of its builder; 0 for all. robust: its watertight mode, which ours always is.
    EmbreeSide(const Scene& scene, unsigned threads, RTCBuildQuality quality, bool robust);

    /// Builds afresh and keeps the result.
    Build build();

    /// Closest hits of `rays`, one by one.
    std::vector<CameraHit> closest_hits(std::span<const BenchRay> rays) const;

    /// Calls of 1, 8 and 16 rays and streams, each told that the rays are coherent and that they are not. Packets that
    /// this processor has no vectors for are left out. Each reads rays in the layout that the call takes, and writes
    /// distance, weights and id, or one byte of visibility. Must not outlive this.
    std::vector<Variant> variants(const RaySet& set) const;

  private:
    struct ReleaseDevice {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    };
    struct ReleaseScene {
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };

    void attach_triangles(RTCScene scene) const;
    void attach_spheres(RTCScene scene) const;

    const Scene& scene_;
    std::vector<glm::vec4> spheres_;  // Embree loads sixteen aligned bytes a sphere: ours do not do
    RTCBuildQuality quality_;
    bool robust_;
    std::atomic<std::ptrdiff_t> bytes_ = 0;  // that Embree holds; before the device, which reports to it
    std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
    std::unique_ptr<RTCSceneTy, ReleaseScene> built_;
};

}  // namespace raymill::bench
