// One launch of a stage, taken out of a frame: its input queue, where it came from, and a digest of what it wrote.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capture/digest.hpp"
#include "profile/profile.hpp"
#include "scene/scene.hpp"
#include "wavefront/film_planes.hpp"

namespace raymill::capture {

/// What of a frame a stage depends on, beside the queue: enough to load its scene again.
struct FrameKey {
    std::string scene_file;  // absolute
    std::uint64_t scene_hash = 0;
    int width = 0, height = 0, spp = 0, depth = 0;
    std::uint32_t seed = 0;
    Crop crop;
    FilmPlanes planes;
};

FrameKey frame_key(const Scene& scene, const FilmPlanes& planes);

/// Which lists are filled depends on the stage: generate none; intersect rays; shade and secondary rays and hits;
/// shadow shadow_rays and shadow_counts.
struct Capture {
    FrameKey frame;
    profile::Stage stage = profile::Stage::intersect;
    int depth = 0;                   // of the rays
    std::uint64_t launch = 0;        // of this stage on rays of this depth, from 0 on
    std::uint32_t count = 0;         // rays of the wave
    std::uint64_t first_sample = 0;  // camera sample of the first ray; generate
    SlotRange slots;                 // light samples of the pass; shade and shadow
    std::vector<Ray> rays;
    std::vector<Hit> hits;
    std::vector<ShadowRay> shadow_rays;        // those of each segment, one segment after another
    std::vector<std::uint32_t> shadow_counts;  // of a segment
    Digest digest;                             // of what the stage wrote

    /// Of the stage's input queue: shadow rays for shadow, else rays.
    std::uint64_t items() const;
};

/// The stages that can be captured, in the order of the loop.
inline constexpr profile::Stage stages[] = {profile::Stage::generate, profile::Stage::intersect, profile::Stage::shade,
                                            profile::Stage::shadow, profile::Stage::secondary};

/// The rays of segments of CHUNK places without the places that hold none, and back, where such places are zero.
std::vector<ShadowRay> pack_segments(const std::vector<ShadowRay>& places, const std::vector<std::uint32_t>& counts);
std::vector<ShadowRay> unpack_segments(const std::vector<ShadowRay>& rays, const std::vector<std::uint32_t>& counts);

/// Whether the scene, with the capture's settings, has everything that the queue's items name: pixels, primitives,
/// light samples. What kernels are given unseen would else lead them out of their buffers.
bool fits(const Capture& capture, const Scene& scene);

/// A capture, and the scene as the frame had it.
struct LoadedCapture {
    Capture capture;
    Scene scene;
};

/// Reads a capture and loads its scene: from `scene_file`, or where it was. scene_argument: how the command line names
/// that file, for messages. Throws UsageError with one sentence (not a capture, damaged, another version, another
/// scene), SceneError.
LoadedCapture load_capture(const std::string& file, const std::string& scene_file, const std::string& scene_argument);

}  // namespace raymill::capture
