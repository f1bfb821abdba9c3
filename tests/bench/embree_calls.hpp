// Embree's calls behind one shape: `closest` and `any` over an array of rays in the layout that the call takes.
// What is read stays as it is: a ray is copied to the stack, where Embree replaces its end by the hit.
#pragma once

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "ray_sets.hpp"

namespace raymill::bench {

/// Rays of a task: large enough that handing it out costs nothing, small enough for many a core.
inline constexpr std::size_t TASK_RAYS = 4096;
inline constexpr std::size_t STREAM_RAYS = 1024;

/// work(first, end) for pieces of TASK_RAYS on all threads, with denormal numbers off, as Embree's manual asks.
template <class Work>
void for_chunks(std::size_t count, const Work& work) {
    const std::size_t tasks = (count + TASK_RAYS - 1) / TASK_RAYS;
    const auto run = [&](const tbb::blocked_range<std::size_t>& range) {
        const unsigned control = _mm_getcsr();
        _mm_setcsr(control | 0x8040);  // flush to zero, denormals are zero
        for (std::size_t task = range.begin(); task < range.end(); ++task)
            work(task * TASK_RAYS, std::min(count, (task + 1) * TASK_RAYS));
        _mm_setcsr(control);
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tasks, 1), run, tbb::simple_partitioner());
}

/// The id that both sides use: spheres count on from the triangles.
inline std::uint32_t primitive_of(unsigned geometry, unsigned primitive, std::uint32_t sphere_offset) {
    return geometry == RTC_INVALID_GEOMETRY_ID ? NO_INDEX : geometry == 0 ? primitive : primitive + sphere_offset;
}

inline RTCRay ray_of(const BenchRay& ray) {
    return {ray.origin.x,
            ray.origin.y,
            ray.origin.z,
            0,
            ray.direction.x,
            ray.direction.y,
            ray.direction.z,
            0,
            ray.t_max,
            ~0u,
            0,
            0};
}

inline RTCRayHit query_of(const RTCRay& ray) {
    RTCRayHit query;
    query.ray = ray;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

/// Hits of `N` rays, as wide as ours: 16 bytes each.
template <int N>
struct HitsOf {
    float t[N];
    float u[N];
    float v[N];
    std::uint32_t primitive[N];
};

inline void store_hit(const RTCRayHit& query, std::uint32_t sphere_offset, HitsOf<1>& hit) {
    hit = {{query.ray.tfar},
           {query.hit.u},
           {query.hit.v},
           {primitive_of(query.hit.geomID, query.hit.primID, sphere_offset)}};
}

/// One ray a call.
struct SingleCall {
    using Rays = RTCRay;
    using Hits = HitsOf<1>;
    static constexpr std::size_t width = 1;
    static std::string name(bool coherent) { return fmt::format("embree 1 {}", coherent ? "coherent" : "incoherent"); }

    static Rays pack(std::span<const BenchRay> rays) { return ray_of(rays.front()); }

    static void closest(RTCScene scene, RTCIntersectContext& context, std::uint32_t sphere_offset, const Rays* rays,
                        std::size_t count, Hits* hits) {
        for (std::size_t i = 0; i < count; ++i) {
            RTCRayHit query = query_of(rays[i]);
            rtcIntersect1(scene, &context, &query);
            store_hit(query, sphere_offset, hits[i]);
        }
    }
    static void any(RTCScene scene, RTCIntersectContext& context, const Rays* rays, std::size_t count,
                    std::uint8_t* blocked) {
        for (std::size_t i = 0; i < count; ++i) {
            RTCRay ray = rays[i];
            rtcOccluded1(scene, &context, &ray);
            blocked[i] = ray.tfar < 0;
        }
    }
};

/// Streams of STREAM_RAYS rays.
struct StreamCall {
    using Rays = RTCRay;
    using Hits = HitsOf<1>;
    static constexpr std::size_t width = 1;
    static std::string name(bool coherent) { return fmt::format("embree 1M {}", coherent ? "coherent" : "incoherent"); }

    static Rays pack(std::span<const BenchRay> rays) { return ray_of(rays.front()); }

    static void closest(RTCScene scene, RTCIntersectContext& context, std::uint32_t sphere_offset, const Rays* rays,
                        std::size_t count, Hits* hits) {
        RTCRayHit stream[STREAM_RAYS];
        for (std::size_t first = 0; first < count; first += STREAM_RAYS) {
            const std::size_t n = std::min(STREAM_RAYS, count - first);
            for (std::size_t i = 0; i < n; ++i) stream[i] = query_of(rays[first + i]);
            rtcIntersect1M(scene, &context, stream, static_cast<unsigned>(n), sizeof(RTCRayHit));
            for (std::size_t i = 0; i < n; ++i) store_hit(stream[i], sphere_offset, hits[first + i]);
        }
    }
    static void any(RTCScene scene, RTCIntersectContext& context, const Rays* rays, std::size_t count,
                    std::uint8_t* blocked) {
        RTCRay stream[STREAM_RAYS];
        for (std::size_t first = 0; first < count; first += STREAM_RAYS) {
            const std::size_t n = std::min(STREAM_RAYS, count - first);
            std::copy_n(rays + first, n, stream);
            rtcOccluded1M(scene, &context, stream, static_cast<unsigned>(n), sizeof(RTCRay));
            for (std::size_t i = 0; i < n; ++i) blocked[first + i] = stream[i].tfar < 0;
        }
    }
};

/// Rays in packets of N, as arrays of each component. Lanes beyond the last ray repeat it with an empty range.
template <int N, class PacketRays, class PacketQuery>
struct PacketLayout {
    using Rays = PacketRays;
    using Hits = HitsOf<N>;
    static constexpr std::size_t width = N;

    static Rays pack(std::span<const BenchRay> rays) {
        Rays packet{};
        for (std::size_t lane = 0; lane < width; ++lane) {
            const BenchRay& ray = rays[std::min(lane, rays.size() - 1)];
            packet.org_x[lane] = ray.origin.x;
            packet.org_y[lane] = ray.origin.y;
            packet.org_z[lane] = ray.origin.z;
            packet.dir_x[lane] = ray.direction.x;
            packet.dir_y[lane] = ray.direction.y;
            packet.dir_z[lane] = ray.direction.z;
            packet.tfar[lane] = lane < rays.size() ? ray.t_max : -1;
            packet.mask[lane] = ~0u;
        }
        return packet;
    }

    static PacketQuery query_of(const Rays& rays) {
        PacketQuery query;
        query.ray = rays;
        std::fill_n(query.hit.geomID, N, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(query.hit.instID[0], N, RTC_INVALID_GEOMETRY_ID);
        return query;
    }

    static void store_hits(const PacketQuery& query, std::uint32_t sphere_offset, Hits& hits) {
        std::copy_n(query.ray.tfar, N, hits.t);
        std::copy_n(query.hit.u, N, hits.u);
        std::copy_n(query.hit.v, N, hits.v);
        for (int lane = 0; lane < N; ++lane)
            hits.primitive[lane] = primitive_of(query.hit.geomID[lane], query.hit.primID[lane], sphere_offset);
    }

    static void store_blocked(const Rays& rays, std::uint8_t* blocked) {
        for (int lane = 0; lane < N; ++lane) blocked[lane] = rays.tfar[lane] < 0;
    }
};

/// N rays a call.
template <int N, class PacketRays, class PacketQuery, auto intersect, auto occluded>
struct PacketCall : PacketLayout<N, PacketRays, PacketQuery> {
    using Layout = PacketLayout<N, PacketRays, PacketQuery>;
    using Rays = typename Layout::Rays;
    using Hits = typename Layout::Hits;
    static std::string name(bool coherent) {
        return fmt::format("embree {} {}", N, coherent ? "coherent" : "incoherent");
    }

    static void closest(RTCScene scene, RTCIntersectContext& context, std::uint32_t sphere_offset, const Rays* rays,
                        std::size_t count, Hits* hits) {
        alignas(64) int valid[N];
        std::fill_n(valid, N, -1);
        for (std::size_t i = 0; i < count; ++i) {
            PacketQuery query = Layout::query_of(rays[i]);
            intersect(valid, scene, &context, &query);
            Layout::store_hits(query, sphere_offset, hits[i]);
        }
    }
    static void any(RTCScene scene, RTCIntersectContext& context, const Rays* rays, std::size_t count,
                    std::uint8_t* blocked) {
        alignas(64) int valid[N];
        std::fill_n(valid, N, -1);
        for (std::size_t i = 0; i < count; ++i) {
            Rays packet = rays[i];
            occluded(valid, scene, &context, &packet);
            Layout::store_blocked(packet, blocked + i * N);
        }
    }
};

/// Streams of STREAM_RAYS rays in packets of 16.
struct PacketStreamCall : PacketLayout<16, RTCRay16, RTCRayHit16> {
    static constexpr std::size_t stream = STREAM_RAYS / width;
    static std::string name(bool coherent) { return fmt::format("embree NM {}", coherent ? "coherent" : "incoherent"); }

    static void closest(RTCScene scene, RTCIntersectContext& context, std::uint32_t sphere_offset, const Rays* rays,
                        std::size_t count, Hits* hits) {
        RTCRayHit16 queries[stream];
        for (std::size_t first = 0; first < count; first += stream) {
            const std::size_t n = std::min(stream, count - first);
            for (std::size_t i = 0; i < n; ++i) queries[i] = query_of(rays[first + i]);
            rtcIntersectNM(scene, &context, reinterpret_cast<RTCRayHitN*>(queries), width, static_cast<unsigned>(n),
                           sizeof(RTCRayHit16));
            for (std::size_t i = 0; i < n; ++i) store_hits(queries[i], sphere_offset, hits[first + i]);
        }
    }
    static void any(RTCScene scene, RTCIntersectContext& context, const Rays* rays, std::size_t count,
                    std::uint8_t* blocked) {
        RTCRay16 packets[stream];
        for (std::size_t first = 0; first < count; first += stream) {
            const std::size_t n = std::min(stream, count - first);
            std::copy_n(rays + first, n, packets);
            rtcOccludedNM(scene, &context, reinterpret_cast<RTCRayN*>(packets), width, static_cast<unsigned>(n),
                          sizeof(RTCRay16));
            for (std::size_t i = 0; i < n; ++i) store_blocked(packets[i], blocked + (first + i) * width);
        }
    }
};

using PacketCall4 = PacketCall<4, RTCRay4, RTCRayHit4, rtcIntersect4, rtcOccluded4>;
using PacketCall8 = PacketCall<8, RTCRay8, RTCRayHit8, rtcIntersect8, rtcOccluded8>;
using PacketCall16 = PacketCall<16, RTCRay16, RTCRayHit16, rtcIntersect16, rtcOccluded16>;

/// All rays in the layout of the call.
template <class Call>
std::vector<typename Call::Rays> pack_rays(std::span<const BenchRay> rays) {
    std::vector<typename Call::Rays> packed;
    packed.reserve((rays.size() + Call::width - 1) / Call::width);
    for (std::size_t first = 0; first < rays.size(); first += Call::width)
        packed.push_back(Call::pack(rays.subspan(first, std::min(Call::width, rays.size() - first))));
    return packed;
}

}  // namespace raymill::bench
