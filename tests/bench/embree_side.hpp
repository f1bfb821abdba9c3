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

/// Of Embree's hierarchy: high splits triangles in space, and takes longer to build.
enum class Quality { medium, high };
const char* name_of(Quality quality);

// Ids of Embree's geometries; primitives in them count as in the scene.
inline constexpr unsigned EMBREE_TRIANGLES = 0;
inline constexpr unsigned EMBREE_SPHERES = 1;

/// Shares the scene's arrays of triangles: it must outlive this.
class EmbreeSide {
  public:
    /// threads: of its builder; 0 for all. robust: its watertight mode, which ours always is.
    EmbreeSide(const Scene& scene, unsigned threads, bool robust);

    /// Builds a hierarchy of this quality afresh, and keeps it beside those of other qualities. occluded_filter: called
    /// where occlusion rays hit anything.
    Build build(Quality quality, RTCFilterFunctionN occluded_filter = nullptr);

    /// The first hierarchy that was built.
    RTCScene scene() const { return built_.front().scene.get(); }

    /// Closest hits of `rays`, one by one, by the first hierarchy that was built.
    std::vector<CameraHit> closest_hits(std::span<const BenchRay> rays) const;

    /// Calls of 1, 4, 8 and 16 rays, and streams of single rays (1M) and of packets (NM), each on every hierarchy built
    /// and told that the rays are coherent and that they are not. Packets that this processor has no vectors for are
    /// left out. Each reads rays in the layout that the call takes, and writes
    /// distance, weights and id, or one byte of visibility. Must not outlive this.
    std::vector<Variant> variants(const RaySet& set) const;

  private:
    struct ReleaseDevice {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    };
    struct ReleaseScene {
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };

    struct Hierarchy {
        Quality quality;
        std::unique_ptr<RTCSceneTy, ReleaseScene> scene;
    };

    void attach_triangles(RTCScene scene, RTCFilterFunctionN occluded_filter) const;
    void attach_spheres(RTCScene scene, RTCFilterFunctionN occluded_filter) const;

    const Scene& scene_;
    std::vector<glm::vec4> spheres_;  // Embree loads sixteen aligned bytes a sphere: ours do not do
    bool robust_;
    std::atomic<std::ptrdiff_t> bytes_ = 0;  // that Embree holds; before the device, which reports to it
    std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
    std::vector<Hierarchy> built_;
};

}  // namespace raymill::bench
