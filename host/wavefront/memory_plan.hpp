// How much device memory a frame takes, known before the first ray.
#pragma once

#include <cstdint>
#include <string>

#include "bvh/bvh.hpp"
#include "device/device.hpp"
#include "scene/scene.hpp"
#include "wavefront/film_planes.hpp"

namespace raymill {

/// Bytes of device memory by purpose.
struct MemoryPlan {
    uint queue_capacity = 0;  // rays of a batch
    int queues = 0;           // depths that have a queue
    int pipelines = 1;        // sets of queues: see Pipeline
    std::uint64_t geometry = 0;
    std::uint64_t textures = 0;
    std::uint64_t ray_queues = 0;  // pipelines * capacity * (1 + 2 * depth) rays
    std::uint64_t hits = 0;
    std::uint64_t shadow_queue = 0;
    std::uint64_t film = 0;  // integer sums and resolved pixels

    std::uint64_t total() const { return geometry + textures + ray_queues + hits + shadow_queue + film; }
    /// What the stages of one wave go through, beside scene and film: its rays, hits, shadow rays and children. Each
    /// pipeline has one.
    std::uint64_t wave_bytes() const;
};

struct MemoryRequest {
    std::uint64_t queue_capacity = 0;  // rays; 0: as many as suit the device's compute units, or fit
    std::uint64_t limit = 0;           // bytes; 0: what the device has
    int pipelines = 2;                 // at most, 1 or more: fewer where camera rays fill fewer waves or so many do not fit
};

/// The plan for a frame of this scene. Throws DeviceError if it does not fit, with what to change.
MemoryPlan plan_memory(const Scene& scene, const Bvh& bvh, const FilmPlanes& planes, const MemoryRequest& request,
                       const DeviceInfo& device);

/// "1.5 GiB".
std::string human_bytes(std::uint64_t bytes);

}  // namespace raymill
