// The rays that both sides trace: camera rays, and those that a renderer would send from their hits.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scenes.hpp"

namespace raymill::bench {

struct BenchRay {
    glm::vec3 origin;
    float t_max = INFINITY;  // distance: direction is unit
    glm::vec3 direction;
};

/// A queue of rays in the order that the renderer would trace them in.
struct RaySet {
    std::string name;
    std::string description;
    bool any_hit = false;  // whether a ray is blocked, not by what
    std::vector<BenchRay> rays;
    std::vector<std::uint32_t> segments;  // any_hit: rays from each CHUNK hits, as `shade` leaves them in its queue
};

/// Where camera ray i hit: NO_INDEX and anything where it did not.
struct CameraHit {
    std::uint32_t primitive = NO_INDEX;
    float t = 0;
    float u = 0;  // weights of vertices 1 and 2
    float v = 0;
};

/// P: one ray a pixel through its centre, in tiles of TILE x TILE pixels. width and height are multiples of TILE.
RaySet camera_rays(const Camera& camera, int width, int height);

inline constexpr double GLASS_INDEX = 1.5;

/// S, A, R, T and D, made from the hits of P.
///   S: shadow rays to the lamp's point           A: to random points of its square, from the side it shines on
///   R: mirrored about the geometric normal       T: refracted by it into a solid of GLASS_INDEX, from inside
///   D: bounced, cosine-distributed, of a fixed seed
/// Origins lie off the surface by 2^-16 of its distance from the world's origin or from the eye, whichever is larger,
/// so that neither side can see the surface that a ray starts on.
std::vector<RaySet> bounced_rays(const BenchScene& bench, const RaySet& camera, std::span<const CameraHit> hits);

}  // namespace raymill::bench
