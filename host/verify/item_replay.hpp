// Runs a stage once more over a queue whose items are each given a pixel of their own, so that a private film tells
// what every single item adds, and whatever the stage pushes tells which item it came from.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "wavefront/stages.hpp"

namespace raymill::verify {

/// Film units (2^-32) of a colour.
using Units = std::array<std::int64_t, 3>;

/// What one item adds to the film, by the lecture's terms, whatever the route of its ray.
struct Contribution {
    Units ambient{}, diffuse{}, specular{}, emission{};
    std::int64_t coverage = 0;

    Units total() const;
};

struct ShadeReplay {
    std::vector<Contribution> added;  // one a hit
    std::vector<ShadowRay> rays;      // CHUNK a segment; `pixel` is the index of the hit
    std::vector<uint> counts;
};

class ItemReplay {
  public:
    /// The references must outlive it.
    ItemReplay(const Device& device, Stages& stages, const DeviceScene& scene);

    /// What rays that miss bring home.
    std::vector<Contribution> intersect(std::span<const Ray> rays);
    ShadeReplay shade(std::span<const Ray> rays, std::span<const Hit> hits, SlotRange slots);
    /// One contribution for each place of the segments; those beyond a segment's count are zero.
    std::vector<Contribution> shadow(std::span<const ShadowRay> rays, std::span<const uint> counts);

  private:
    Buffer<Ray> renamed(std::span<const Ray> rays) const;
    DeviceScene scene_for(std::size_t items) const;
    Film film_for(std::size_t items) const;
    std::vector<Contribution> read(const Film& film, std::size_t items) const;

    const Device& device_;
    Stages& stages_;
    const DeviceScene& scene_;
    FilmPlanes planes_;
};

}  // namespace raymill::verify
