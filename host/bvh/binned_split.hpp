// Where to cut a range of primitives in two: the surface area heuristic over up to 16 bins on each axis.
// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies" (2007), section 3.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "bvh/primitive_refs.hpp"

namespace raymill::bvh {

inline constexpr int MAX_BIN_COUNT = 16;

struct RangeBounds {
    Box box;
    Box half_centroids;

    void add(const RangeBounds& other) {
        box.add(other.box);
        half_centroids.add(other.half_centroids);
    }
};

/// Bounds of the primitives and of their half centroids. Not for an empty range.
RangeBounds measure(std::span<const PrimitiveRef> refs);

/// Bins for a range of this many primitives: a few primitives need no fine grid, and most ranges are small.
int bin_count(std::size_t primitives);

/// Maps a primitive to its bin on each axis. An axis on which all centroids agree has all of them in bin 0.
class BinGrid {
  public:
    BinGrid(const Box& half_centroids, int bin_count);

    int bin_count() const { return bin_count_; }
    Int4 bins(const PrimitiveRef& ref) const {
        return __builtin_convertvector((ref.half_centroid() - base_) * scale_, Int4);
    }

  private:
    Float4 base_;
    Float4 scale_;
    int bin_count_;
};

/// Primitives in bins below `bin` on `axis` go left: left_count of them, neither none nor all.
struct Split {
    int axis = 0;
    int bin = 0;
    std::size_t left_count = 0;
    Box left, right;  // bounds of either side

    bool goes_left(const BinGrid& grid, const PrimitiveRef& ref) const { return grid.bins(ref)[axis] < bin; }
};

/// The split that minimises area times leaf blocks, summed over both sides; `box` bounds them all. None if all
/// centroids agree, up to the smallest distances that bins can tell.
std::optional<Split> find_split(std::span<const PrimitiveRef> refs, const Box& box, const BinGrid& grid);

struct Halves {
    RangeBounds left, right;
};

/// Copies `source` to `target`, left side first; each side keeps its order.
Halves partition(std::span<const PrimitiveRef> source, PrimitiveRef* target, const BinGrid& grid, const Split& split);

}  // namespace raymill::bvh
