// Our side: the hierarchy, the stages `intersect` and `shadow` as the renderer runs them, and their traversal alone.
#pragma once

#include <memory>
#include <vector>

#include "bvh/bvh.hpp"
#include "ray_sets.hpp"
#include "variant.hpp"
#include "wavefront/stages.hpp"

namespace raymill::bench {

/// The variant that traces as the renderer does when nobody asks for a traversal.
inline constexpr const char* AUTOMATIC = "raymill automatic";

/// Builds the hierarchy and keeps the last one built.
class RaymillHierarchy {
  public:
    RaymillHierarchy(const Scene& scene, BvhOptions options) : scene_(scene), options_(options) {}
    Build build();
    const Bvh& bvh() const { return bvh_; }

  private:
    const Scene& scene_;
    BvhOptions options_;
    Bvh bvh_;
};

/// The kernels, built once a traversal, for any number of scenes.
class RaymillKernels {
  public:
    /// device, threads: see open_device. folders: of other kernels, to be measured beside the project's. Throws
    /// DeviceError.
    RaymillKernels(const std::string& device, unsigned threads, const std::vector<Traversal>& traversals,
                   const std::vector<std::string>& folders = {});

    struct Kind {
        std::string name;
        std::unique_ptr<Stages> stages;
        cl::Kernel closest, occlusion;  // of traversal.cl
        std::size_t rays_a_work_item;   // of these
    };
    const Device& device() const { return device_; }
    const std::vector<Kind>& kinds() const { return kinds_; }

  private:
    /// folder: of the kernels; empty for the project's.
    void add(Traversal traversal, const std::string& folder, const std::string& name);

    Device device_;
    std::vector<Kind> kinds_;
};

/// A scene on the device. The hierarchy must outlive it.
class RaymillSide {
  public:
    RaymillSide(const RaymillKernels& kernels, const Scene& scene, const Bvh& bvh)
        : kernels_(kernels), scene_(kernels.device(), scene, bvh) {}

    /// Two variants a traversal, all rays in one queue and launch: the traversal alone, which writes hits, or of shadow
    /// rays a byte that says whether each is blocked; and the whole stage, in which rays that miss look up a black
    /// background, and an unblocked shadow ray adds 1 to one channel of its own pixel. Must not outlive this.
    std::vector<Variant> variants(const RaySet& set);

  private:
    std::vector<Variant> closest_variants(const RaySet& set);
    std::vector<Variant> shadow_variants(const RaySet& set);
    Variant occlusion_variant(const RaymillKernels::Kind& kind, std::shared_ptr<ShadowQueue> rays);
    Variant shadow_variant(const RaymillKernels::Kind& kind, std::shared_ptr<ShadowQueue> rays, std::size_t count);
    /// Sets the arguments, launches, and waits.
    template <typename... Arguments>
    void run(cl::Kernel& kernel, std::size_t work_items, const Arguments&... arguments) const;

    const RaymillKernels& kernels_;
    DeviceScene scene_;
};

}  // namespace raymill::bench
