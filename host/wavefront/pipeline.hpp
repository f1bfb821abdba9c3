// What the waves of a frame go through: its queues, and a command queue to launch on.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "wavefront/memory_plan.hpp"
#include "wavefront/stages.hpp"
#include "wavefront/waves.hpp"

namespace raymill {

/// Waves of different pipelines run at the same time, those of one after another: while the host waits for a wave of
/// one and launches its next, the device has that of another. So a stage may write what is its pipeline's, and to what
/// all share add atomically. Camera rays that begin in a pipeline and all that descend from them stay in it; with one
/// sample a pixel, the pixel is the pipeline's too, which is what pixels_once() relies on.
struct Pipeline {
    Device device;  // with a command queue that no other pipeline has
    Waves waves;
    std::vector<Buffer<Ray>> queues;  // by depth
    Buffer<Hit> hits;
    ShadowQueue shadow_queue;
    Film film;                     // sums that all pipelines add to, counters of its own
    std::optional<Batch> running;  // the wave that was launched last, while nobody has waited for it

    /// slots: most light samples of a pass. passes: over the light samples. sums: see Film.
    Pipeline(Device opened, const MemoryPlan& plan, uint slots, std::size_t passes, Buffer<cl_long> sums)
        : device(std::move(opened)), waves(plan.queue_capacity, plan.queues - 1) {
        for (int depth = 0; depth < plan.queues; ++depth) queues.emplace_back(device, waves.queue_size(depth));
        const std::size_t segments = std::size_t{Stages::chunks(plan.queue_capacity)} * slots;
        hits = Buffer<Hit>(device, plan.queue_capacity);
        shadow_queue = {{device, segments * CHUNK}, {device, segments}};
        film = {std::move(sums), {device, passes}};
    }

    QueueRange<Ray> rays(const Batch& batch) const {
        return {queues[static_cast<std::size_t>(batch.depth)], batch.first, batch.count};
    }
    Buffer<Ray>& children(const Batch& batch) { return queues[static_cast<std::size_t>(batch.depth) + 1]; }
};

}  // namespace raymill
