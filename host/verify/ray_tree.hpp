// All rays of one pixel, linked from children to parents, with what each of them added to the film.
#pragma once

#include <optional>
#include <vector>

#include "verify/wave_recorder.hpp"

namespace raymill::verify {

/// One camera or secondary ray, as the kernels had it in their queues.
struct RayNode {
    Ray ray;
    Hit hit;
    int depth = 0;
    Contribution added;                    // background, ambient, emission
    std::vector<ShadowItem> shadow_rays;   // in the order of the light samples
    std::optional<std::size_t> reflected;  // indices of the children
    std::optional<std::size_t> refracted;
};

struct RayTree {
    std::vector<RayNode> nodes;
    std::vector<std::size_t> roots;                    // the camera ray of each sample
    std::array<std::int64_t, FILM_CHANNELS> booked{};  // sum of all that the nodes added: R, G, B, coverage
    std::array<std::int64_t, FILM_CHANNELS> film{};    // what the film holds
    std::size_t contributions = 0;                     // that are not zero

    bool sums_agree() const { return booked == film; }
};

/// Makes pixel (x, y), which must lie in the image, the rendered window.
void crop_to_pixel(RenderSettings& settings, int x, int y);

/// Renders the window of the renderer's scene, which must be one pixel. Throws DeviceError, QueueOverflow.
RayTree trace_pixel(const Device& device, Renderer& renderer);

}  // namespace raymill::verify
