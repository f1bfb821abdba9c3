// Compares what a captured launch writes with the reference.
#pragma once

#include "capture/capture.hpp"
#include "verify/verifier.hpp"

namespace raymill::verify {

/// Runs the captured stage once. on_device: of the capture's scene, with the planes that its frame kept.
/// Throws DeviceError, QueueOverflow.
StageReport verify_capture(const Device& device, const Scene& scene, Stages& stages, const DeviceScene& on_device,
                           const capture::Capture& capture, const VerifyOptions& options);

}  // namespace raymill::verify
