#include "bvh/binned_split.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace raymill::bvh {
namespace {

constexpr std::size_t PARALLEL_SIZE = 65536;  // shorter ranges are not worth sharing out
constexpr std::size_t CHUNK_SIZE = 16384;     // primitives a task handles
constexpr std::size_t TURNS_SIZE = 256;       // from here on, several sets of bins are worth adding up

/// Minima, maxima and counts: the same whatever the order of additions, and so for any number of threads.
class Bins {
  public:
    explicit Bins(int bin_count) : used_(bin_count) {
        for (int axis = 0; axis < 3; ++axis)
            for (int bin = 0; bin < used_; ++bin) axis_[axis].box[bin] = Box{};
        std::memset(count_, 0, sizeof count_);
    }

    void add(const PrimitiveRef& ref, const BinGrid& grid) {
        const Int4 bins = grid.bins(ref);
        const Box bounds = ref.box();
        for (int axis = 0; axis < 3; ++axis) {
            axis_[axis].box[bins[axis]].add(bounds);
            ++count_[bins[axis]][axis];
        }
    }

    void add(std::span<const PrimitiveRef> refs, const BinGrid& grid) {
        std::size_t i = 0;
        if (refs.size() >= TURNS_SIZE) {
            // Neighbours often fall into one bin, which cannot be read until it is written: so they take turns at four.
            Bins second(used_), third(used_), fourth(used_);
            for (; i + 4 <= refs.size(); i += 4) {
                add(refs[i], grid);
                second.add(refs[i + 1], grid);
                third.add(refs[i + 2], grid);
                fourth.add(refs[i + 3], grid);
            }
            add(second);
            add(third);
            add(fourth);
        }
        for (; i < refs.size(); ++i) add(refs[i], grid);
    }

    void add(const Bins& other) {
        for (int bin = 0; bin < used_; ++bin)
            for (int axis = 0; axis < 3; ++axis) {
                axis_[axis].box[bin].add(other.axis_[axis].box[bin]);
                count_[bin][axis] += other.count_[bin][axis];
            }
    }

    int used() const { return used_; }
    const Box& box(int bin, int axis) const { return axis_[axis].box[bin]; }
    /// One lane an axis; lane 3 is zero.
    Int4 counts(int bin) const {
        Int4 counts;
        std::memcpy(&counts, count_[bin], sizeof counts);
        return counts;
    }

  private:
    union Boxes {  // not initialised: most ranges are small and use few bins
        Boxes() {}
        Box box[MAX_BIN_COUNT];
    };
    Boxes axis_[3];
    std::int32_t count_[MAX_BIN_COUNT][4];
    int used_;
};

/// Calls add(part of the range, accumulator) on chunks, in parallel if the range is long, and joins the accumulators.
template <typename Result, typename Add>
void reduce(std::span<const PrimitiveRef> refs, Result& result, const Add& add) {
    if (refs.size() < PARALLEL_SIZE) return add(refs, result);
    result = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, refs.size(), CHUNK_SIZE), result,
        [&](const tbb::blocked_range<std::size_t>& part, Result partial) {
            add(refs.subspan(part.begin(), part.size()), partial);
            return partial;
        },
        [](Result a, const Result& b) {
            a.add(b);
            return a;
        });
}

/// Half areas of boxes in units in which the largest box of a node has edges of at most one: floats suffice.
class AreaScale {
  public:
    explicit AreaScale(const Box& largest) {
        const Float4 halves = largest.upper * splat(0.5f) - largest.lower * splat(0.5f);  // cannot overflow
        const float edge = std::max({halves[0], halves[1], halves[2]});
        scale_ = splat(0.5f / std::max(edge, 1e-37f));
    }

    /// Of three boxes at once, in lanes 0 to 2. Infinite for empty ones.
    Float4 half_areas(const Box (&box)[3]) const {
        const Float4 a = extent(box[0]), b = extent(box[1]), c = extent(box[2]);
        const Float4 x = {a[0], b[0], c[0], 0}, y = {a[1], b[1], c[1], 0}, z = {a[2], b[2], c[2], 0};
        return x * (y + z) + y * z;
    }

  private:
    Float4 extent(const Box& box) const { return box.upper * scale_ - box.lower * scale_; }

    Float4 scale_;
};

Float4 leaf_blocks(Int4 count) {
    static_assert(BVH_WIDTH == 1 << 3);
    return __builtin_convertvector((count + (BVH_WIDTH - 1)) >> 3, Float4);
}

/// The bins of all three axes, taken up one by one from either end.
struct Sweep {
    Box box[3];
    Int4 count = {};

    void add(const Bins& bins, int bin) {
        for (int axis = 0; axis < 3; ++axis) box[axis].add(bins.box(bin, axis));
        count += bins.counts(bin);
    }
    /// NaN where there are no primitives, and so never the least.
    Float4 cost(const AreaScale& area) const { return area.half_areas(box) * leaf_blocks(count); }
};

/// The bin at which to split each axis, in lanes, and what that costs; infinite where it cannot be split.
struct AxisSplits {
    Float4 cost = splat(INFINITY);
    Int4 bin = {};

    AxisSplits(const Bins& bins, const AreaScale& area) {
        Float4 right_cost[MAX_BIN_COUNT];
        Sweep right;
        for (int bin = bins.used() - 1; bin > 0; --bin) {
            right.add(bins, bin);
            right_cost[bin] = right.cost(area);
        }
        Sweep left;
        for (int next = 1; next < bins.used(); ++next) {
            left.add(bins, next - 1);
            const Float4 both = left.cost(area) + right_cost[next];
            const Int4 better = both < cost;
            cost = better ? both : cost;
            bin = better ? Int4{next, next, next, next} : bin;
        }
    }
};

}  // namespace

RangeBounds measure(std::span<const PrimitiveRef> refs) {
    RangeBounds bounds;
    reduce(refs, bounds, [](std::span<const PrimitiveRef> part, RangeBounds& partial) {
        RangeBounds local = partial;  // in registers during the loop
        for (const PrimitiveRef& ref : part) {
            local.box.add(ref.box());
            local.half_centroids.add(ref.half_centroid());
        }
        partial = local;
    });
    return bounds;
}

int bin_count(std::size_t primitives) {
    return static_cast<int>(std::min<std::size_t>(4 + primitives / 8, MAX_BIN_COUNT));
}

BinGrid::BinGrid(const Box& half_centroids, int bin_count)
    : base_(half_centroids.lower), scale_{}, bin_count_(bin_count) {
    const Float4 extent = half_centroids.upper - half_centroids.lower;
    for (int axis = 0; axis < 3; ++axis) {
        // A little less than the number of bins, so that the last centroid does not round into a bin beyond the last.
        const float scale = (static_cast<float>(bin_count) - 0.001f) / extent[axis];
        if (std::isfinite(scale)) scale_[axis] = scale;
    }
}

std::optional<Split> find_split(std::span<const PrimitiveRef> refs, const Box& box, const BinGrid& grid) {
    Bins bins(grid.bin_count());
    reduce(refs, bins, [&](std::span<const PrimitiveRef> part, Bins& partial) { partial.add(part, grid); });
    const AxisSplits found(bins, AreaScale(box));
    Split best;
    for (int axis = 1; axis < 3; ++axis)
        if (found.cost[axis] < found.cost[best.axis]) best.axis = axis;
    if (found.cost[best.axis] == INFINITY) return {};
    best.bin = found.bin[best.axis];
    for (int bin = 0; bin < bins.used(); ++bin) {
        (bin < best.bin ? best.left : best.right).add(bins.box(bin, best.axis));
        if (bin < best.bin) best.left_count += static_cast<std::size_t>(bins.counts(bin)[best.axis]);
    }
    return best;
}

namespace {

/// Bounds of the half centroids on both sides of a split.
struct Centroids {
    Box left, right;

    void add(const Centroids& other) {
        left.add(other.left);
        right.add(other.right);
    }
};

/// Copies primitives of either side to their next places in `target`.
template <int axis>
Centroids scatter_along(std::span<const PrimitiveRef> refs, PrimitiveRef* target, const BinGrid& grid, int bin,
                        std::size_t left, std::size_t right) {
    Centroids bounds;
    const Int4 bins = {bin, bin, bin, bin};
    for (const PrimitiveRef& ref : refs) {
        const Int4 below = grid.bins(ref) < bins;
        const Int4 goes_left = __builtin_shuffle(below, Int4{axis, axis, axis, axis});
        const Float4 centroid = ref.half_centroid();
        bounds.left.add_where(goes_left, centroid);
        bounds.right.add_where(~goes_left, centroid);
        // Which side comes next cannot be predicted: the place is computed, not branched to.
        const auto left_mask = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(goes_left[0]));
        target[right ^ ((left ^ right) & left_mask)] = ref;
        left -= left_mask;
        right += 1 + left_mask;
    }
    return bounds;
}

}  // namespace

Halves partition(std::span<const PrimitiveRef> source, PrimitiveRef* target, const BinGrid& grid, const Split& split) {
    const auto scatter = [&](std::span<const PrimitiveRef> part, std::size_t left, std::size_t right) {
        switch (split.axis) {
            case 0:
                return scatter_along<0>(part, target, grid, split.bin, left, right);
            case 1:
                return scatter_along<1>(part, target, grid, split.bin, left, right);
            default:
                return scatter_along<2>(part, target, grid, split.bin, left, right);
        }
    };
    const auto halves = [&](const Centroids& c) { return Halves{{split.left, c.left}, {split.right, c.right}}; };
    if (source.size() < PARALLEL_SIZE) return halves(scatter(source, 0, split.left_count));

    const std::size_t chunk_count = (source.size() + CHUNK_SIZE - 1) / CHUNK_SIZE;
    const auto chunk = [&](std::size_t i) {
        return source.subspan(i * CHUNK_SIZE, std::min(CHUNK_SIZE, source.size() - i * CHUNK_SIZE));
    };
    std::vector<std::size_t> left_before(chunk_count + 1, 0);
    tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t i) {
        for (const PrimitiveRef& ref : chunk(i)) left_before[i + 1] += split.goes_left(grid, ref);
    });
    for (std::size_t i = 0; i < chunk_count; ++i) left_before[i + 1] += left_before[i];
    std::vector<Centroids> bounds(chunk_count);
    tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t i) {
        const std::size_t right_before = i * CHUNK_SIZE - left_before[i];
        bounds[i] = scatter(chunk(i), left_before[i], split.left_count + right_before);
    });
    for (std::size_t i = 1; i < chunk_count; ++i) bounds[0].add(bounds[i]);
    return halves(bounds[0]);
}

}  // namespace raymill::bvh
