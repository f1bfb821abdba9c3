#include "bvh/primitive_refs.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cstring>
#include <vector>

namespace raymill::bvh {
namespace {

constexpr std::size_t CHUNK_SIZE = 16384;  // primitives a task turns into references

enum class Verdict { keep, not_finite, zero_area };

struct ChunkCounts {
    std::size_t kept = 0;
    std::size_t not_finite = 0;
    std::size_t zero_area = 0;

    void add(Verdict verdict) {
        kept += verdict == Verdict::keep;
        not_finite += verdict == Verdict::not_finite;
        zero_area += verdict == Verdict::zero_area;
    }
};

Float4 with_id(Float4 lower, std::uint32_t id) {
    lower[3] = std::bit_cast<float>(id);
    return lower;
}

/// Turns -0 into +0: the minimum of the two depends on their order, and with it on how threads share the work.
Float4 without_negative_zero(Float4 v) {
    return v + splat(0.0f);
}

Float4 load_position(const Vertex& vertex) {
    static_assert(offsetof(Vertex, position) == 0 && sizeof(Vertex) >= sizeof(Float4));
    Float4 v;
    std::memcpy(&v, &vertex, sizeof v);
    return xyz(v);
}

bool all_finite(Float4 v) {
    const Int4 finite = v - v == splat(0.0f);  // inf - inf and NaN - NaN are NaN
    return finite[0] && finite[1] && finite[2];
}

/// Exact where the edges are: floats within 2^29 of each other in size.
bool has_no_area(Float4 a, Float4 b, Float4 c) {
    double u[3], v[3];
    for (int i = 0; i < 3; ++i) {
        u[i] = static_cast<double>(b[i]) - a[i];
        v[i] = static_cast<double>(c[i]) - a[i];
    }
    return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}

Verdict make_ref(std::span<const Vertex> vertices, const Triangle& triangle, std::uint32_t id, PrimitiveRef& ref) {
    assert(triangle.vertex[0] < vertices.size() && triangle.vertex[1] < vertices.size() &&
           triangle.vertex[2] < vertices.size());
    const Float4 a = load_position(vertices[triangle.vertex[0]]);
    const Float4 b = load_position(vertices[triangle.vertex[1]]);
    const Float4 c = load_position(vertices[triangle.vertex[2]]);
    // One test for three points: what is not finite leaves a NaN in the sum.
    if (!all_finite((a - a) + (b - b) + (c - c))) return Verdict::not_finite;
    if (has_no_area(a, b, c)) return Verdict::zero_area;
    ref.lower_and_id = with_id(without_negative_zero(min(min(a, b), c)), id);
    ref.upper = without_negative_zero(max(max(a, b), c));
    return Verdict::keep;
}

Verdict make_ref(const Sphere& sphere, std::uint32_t id, PrimitiveRef& ref) {
    const Float4 center = {sphere.center[0], sphere.center[1], sphere.center[2], 0.0f};
    if (!all_finite(center) || !std::isfinite(sphere.radius)) return Verdict::not_finite;
    if (!(sphere.radius > 0)) return Verdict::zero_area;
    Float4 lower = {}, upper = {};
    for (int i = 0; i < 3; ++i) {
        // One step beyond the rounded sum encloses the exact one; there is no float beyond the largest.
        lower[i] = std::max(std::nextafter(sphere.center[i] - sphere.radius, -INFINITY), -FLT_MAX);
        upper[i] = std::min(std::nextafter(sphere.center[i] + sphere.radius, INFINITY), FLT_MAX);
    }
    ref.lower_and_id = with_id(without_negative_zero(lower), id);
    ref.upper = without_negative_zero(upper);
    return Verdict::keep;
}

}  // namespace

PrimitiveRefs make_primitive_refs(std::span<const Vertex> vertices, std::span<const Triangle> triangles,
                                  std::span<const Sphere> spheres) {
    const std::size_t total = triangles.size() + spheres.size();
    assert(total < NO_INDEX);
    PrimitiveRefs result;
    result.refs.resize(total);
    PrimitiveRef* refs = result.refs.data();

    // Each chunk is dense at its own place; then the chunks close up, in order.
    std::vector<ChunkCounts> chunks((total + CHUNK_SIZE - 1) / CHUNK_SIZE);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t chunk) {
        const std::size_t begin = chunk * CHUNK_SIZE, end = std::min(begin + CHUNK_SIZE, total);
        ChunkCounts counts;
        for (std::size_t i = begin; i < end; ++i) {
            PrimitiveRef& ref = refs[begin + counts.kept];
            const auto id = static_cast<std::uint32_t>(i);
            counts.add(i < triangles.size() ? make_ref(vertices, triangles[i], id, ref)
                                            : make_ref(spheres[i - triangles.size()], id, ref));
        }
        chunks[chunk] = counts;
    });
    std::size_t count = 0;
    for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
        const PrimitiveRef* begin = refs + chunk * CHUNK_SIZE;
        if (count != chunk * CHUNK_SIZE) std::copy_n(begin, chunks[chunk].kept, refs + count);
        count += chunks[chunk].kept;
        result.dropped_not_finite += chunks[chunk].not_finite;
        result.dropped_zero_area += chunks[chunk].zero_area;
    }
    result.refs.resize(count);
    return result;
}

}  // namespace raymill::bvh
