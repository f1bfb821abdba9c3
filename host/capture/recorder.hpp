// Takes one launch out of a frame while it is rendered.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>

#include "capture/capture.hpp"
#include "wavefront/renderer.hpp"

namespace raymill::capture {

/// What `--capture` asks for.
struct Request {
    profile::Stage stage = profile::Stage::intersect;
    int depth = 0;
    std::optional<std::uint64_t> launch;  // nothing: the fullest
    std::string file;
};

/// "DEPTH[:LAUNCH],STAGE,FILE". Throws UsageError.
Request parse_request(const std::string& text);

/// Keeps the launch that was asked for, of those that it is shown. The fullest writes the most items (hits,
/// shadow rays, children; of generate and shadow nothing counts), and of several such has the most in its input queue;
/// of equal ones it is the first.
class Recorder {
  public:
    /// The device must outlive the recorder.
    Recorder(const Device& device, Request request) : device_(device), request_(std::move(request)) {}

    const Request& request() const { return request_; }

    /// A WaveObserver.
    void see(const std::string& stage, const WaveView& view);

    /// The capture, after the frame and with the renderer that rendered it; nothing if there was no such launch.
    /// The launch is repeated for its digest. Throws QueueMismatch if that does not write what the frame's did.
    std::optional<Capture> finish(const Scene& scene, Renderer& renderer, const FilmPlanes& planes);

    /// Launches of the stage on rays of the depth.
    std::uint64_t launches() const { return launches_; }

  private:
    /// Of two launches, that which writes more does more: items that miss, or hit what no light faces, are soon done.
    struct Work {
        std::uint64_t items_out = 0, items_in = 0;
        auto operator<=>(const Work&) const = default;
    };
    void take(const WaveView& view);
    std::uint64_t items_in(const WaveView& view) const;
    std::uint64_t items_out(const WaveView& view) const;

    const Device& device_;
    Request request_;
    std::uint64_t launches_ = 0;
    Work most_;  // of the launches so far
    std::optional<Capture> capture_;
};

}  // namespace raymill::capture
