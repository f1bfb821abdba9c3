#include "bvh/binned_split.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <vector>

namespace raymill::bvh {
namespace {

constexpr std::size_t PARALLEL_SIZE = 65536;  // shorter ranges are not worth sharing out
constexpr std::size_t CHUNK_SIZE = 16384;     // primitives a task handles

/// Minima, maxima and counts: the same whatever the order of additions, and so for any number of threads.
struct Bins {
    Box box[BIN_COUNT][3];
    std::uint32_t count[BIN_COUNT][3] = {};

    void add(std::span<const PrimitiveRef> refs, const BinGrid& grid) {
        for (const PrimitiveRef& ref : refs) {
            const Int4 bins = grid.bins(ref);
            const Box bounds = ref.box();
            for (int axis = 0; axis < 3; ++axis) {
                box[bins[axis]][axis].add(bounds);
                ++count[bins[axis]][axis];
            }
        }
    }

    void add(const Bins& other) {
        for (int bin = 0; bin < BIN_COUNT; ++bin)
            for (int axis = 0; axis < 3; ++axis) {
                box[bin][axis].add(other.box[bin][axis]);
                count[bin][axis] += other.count[bin][axis];
            }
    }
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

    float half_area(const Box& box) const {
        const Float4 e = box.upper * scale_ - box.lower * scale_;
        return e[0] * (e[1] + e[2]) + e[1] * e[2];
    }

  private:
    Float4 scale_;
};

float leaf_blocks(std::uint32_t count) {
    return static_cast<float>((count + BVH_WIDTH - 1) / BVH_WIDTH);
}

/// What the primitives of bins [bin, BIN_COUNT) cost on one axis; 0 where there are none.
struct RightCosts {
    float cost[BIN_COUNT];

    RightCosts(const Bins& bins, int axis, const AreaScale& area) {
        Box box;
        std::uint32_t count = 0;
        for (int bin = BIN_COUNT - 1; bin > 0; --bin) {
            box.add(bins.box[bin][axis]);
            count += bins.count[bin][axis];
            cost[bin] = count ? area.half_area(box) * leaf_blocks(count) : 0.0f;
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

BinGrid::BinGrid(const Box& half_centroids) : base_(half_centroids.lower), scale_{} {
    const Float4 extent = half_centroids.upper - half_centroids.lower;
    for (int axis = 0; axis < 3; ++axis) {
        // A little less than BIN_COUNT, so that the last centroid does not round into a bin beyond the last.
        const float scale = (BIN_COUNT - 0.001f) / extent[axis];
        if (std::isfinite(scale)) scale_[axis] = scale;
    }
}

std::optional<Split> find_split(std::span<const PrimitiveRef> refs, const RangeBounds& bounds, const BinGrid& grid) {
    Bins bins;
    reduce(refs, bins, [&](std::span<const PrimitiveRef> part, Bins& partial) { partial.add(part, grid); });
    const AreaScale area(bounds.box);
    std::optional<Split> best;
    float best_cost = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        const RightCosts right(bins, axis, area);
        Box box;
        std::uint32_t count = 0;
        for (int bin = 1; bin < BIN_COUNT; ++bin) {
            if (bins.count[bin - 1][axis] == 0) continue;  // the same as splitting at the bin before
            box.add(bins.box[bin - 1][axis]);
            count += bins.count[bin - 1][axis];
            if (count == refs.size()) break;
            const float cost = area.half_area(box) * leaf_blocks(count) + right.cost[bin];
            if (cost < best_cost) {
                best_cost = cost;
                best = Split{axis, bin, count};
            }
        }
    }
    return best;
}

void partition(std::span<const PrimitiveRef> source, PrimitiveRef* target, const BinGrid& grid, const Split& split) {
    // Which side comes next cannot be predicted: the place is computed, not branched to.
    const auto scatter = [&](std::span<const PrimitiveRef> part, std::size_t left, std::size_t right) {
        for (const PrimitiveRef& ref : part) {
            const std::size_t goes_left = split.goes_left(grid, ref);
            target[right + (left - right) * goes_left] = ref;
            left += goes_left;
            right += 1 - goes_left;
        }
    };
    if (source.size() < PARALLEL_SIZE) return scatter(source, 0, split.left_count);

    const std::size_t chunk_count = (source.size() + CHUNK_SIZE - 1) / CHUNK_SIZE;
    const auto chunk = [&](std::size_t i) {
        return source.subspan(i * CHUNK_SIZE, std::min(CHUNK_SIZE, source.size() - i * CHUNK_SIZE));
    };
    std::vector<std::size_t> left_before(chunk_count + 1, 0);
    tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t i) {
        for (const PrimitiveRef& ref : chunk(i)) left_before[i + 1] += split.goes_left(grid, ref);
    });
    for (std::size_t i = 0; i < chunk_count; ++i) left_before[i + 1] += left_before[i];
    tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t i) {
        const std::size_t right_before = i * CHUNK_SIZE - left_before[i];
        scatter(chunk(i), left_before[i], split.left_count + right_before);
    });
}

}  // namespace raymill::bvh
