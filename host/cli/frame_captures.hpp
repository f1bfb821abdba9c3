// The captures that a render was asked for.
#pragma once

#include <string>
#include <vector>

#include "capture/recorder.hpp"

namespace raymill {

class FrameCaptures {
  public:
    /// arguments: of --capture, see capture::parse_request(). Throws UsageError.
    explicit FrameCaptures(const std::vector<std::string>& arguments);

    std::vector<std::string> files() const;
    /// Throws UsageError where the recursion ends before a depth that is asked for.
    void check(const Scene& scene) const;
    /// Watches the following frame, which it slows down; nothing where nothing was asked for.
    void observe(const Device& device, Renderer& renderer);
    /// Throws UsageError if there was no such launch, unless the frame was interrupted; OutputError.
    void write(const Scene& scene, Renderer& renderer, const Frame& frame, bool quiet);

  private:
    std::vector<capture::Request> requests_;
    std::vector<capture::Recorder> recorders_;
};

}  // namespace raymill
