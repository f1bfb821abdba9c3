// The peer of whole frames: the lecture's algorithm as a recursive tracer on Embree, one path at a time on all cores.
// It draws the renderer's random numbers, so that its pictures are the renderer's but for rounding.
#pragma once

#include <vector>

#include "embree_side.hpp"
#include "frames/world.hpp"

namespace raymill::bench {

class EmbreeTracer {
  public:
    /// The scene must outlive this. threads: of the builder, 0 for all.
    EmbreeTracer(const Scene& scene, unsigned threads);

    /// RGBA of the rendered window, row by row from the top, by all threads that TBB has.
    std::vector<float> render() const;

  private:
    World world_;
    EmbreeSide embree_;
};

}  // namespace raymill::bench
