// Camera rays: pinhole, thin lens and orthographic.
#pragma once

#include "frames/sampling.hpp"

namespace raymill::bench {

/// Sample `sample` of pixel (x, y) of the whole image.
inline PathRay camera_ray(const CameraRecord& camera, std::uint32_t x, std::uint32_t y, std::uint32_t sample) {
    const std::uint32_t path = path_camera(camera.seed, y * camera.width + x);
    const vec2 jitter = camera.spp == 1 ? vec2(0.5f) : stratified_sample(sample, path, RANDOM_PIXEL);
    const float right = 2 * ((static_cast<float>(x) + jitter.x) / static_cast<float>(camera.width)) - 1;
    const float up = 1 - 2 * ((static_cast<float>(y) + jitter.y) / static_cast<float>(camera.height));
    const vec3 across = right * vec(camera.right) + up * vec(camera.up);
    vec3 origin = vec(camera.eye), direction = vec(camera.forward);
    (camera.orthographic ? origin : direction) += across;
    if (camera.lens_radius > 0) {
        const vec2 lens = camera.lens_radius * concentric_disk(stratified_sample(sample, path, RANDOM_LENS));
        const vec3 shift = lens.x * glm::normalize(vec(camera.right)) + lens.y * glm::normalize(vec(camera.up));
        origin += shift;
        direction = camera.focus * direction - shift;
    }
    return {origin, glm::normalize(direction), path, sample};
}

}  // namespace raymill::bench
