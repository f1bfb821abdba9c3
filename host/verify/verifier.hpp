// Replays every queue of a frame through the reference.
#pragma once

#include <vector>

#include "verify/film_ledger.hpp"
#include "verify/report.hpp"
#include "verify/wave_recorder.hpp"
#include "wavefront/renderer.hpp"

namespace raymill::verify {

struct VerifyOptions {
    /// Ray and primitive pairs that the reference may test for intersect and for shadow each, since it tests all
    /// primitives for every ray. Beyond it, an evenly spread subset of the items is compared.
    std::uint64_t primitive_tests = 500'000'000;
};

/// One stage's items of a wave that holds what the stage read and wrote. slots: the light samples that shade went
/// through; ambient, emission and coverage belong to the first.
StageReport verify_stage(const Scene& scene, const Wave& wave, profile::Stage stage, SlotRange slots,
                         const VerifyOptions& options);

/// Renders the frame twice, the first time to count its rays. The renderer must keep ledger_planes().
/// One report a kernel, in the order of the wavefront loop, and one of the film's integers.
/// Throws DeviceError, QueueOverflow.
std::vector<StageReport> verify_frame(const Device& device, const Scene& scene, Renderer& renderer,
                                      const VerifyOptions& options);

}  // namespace raymill::verify
