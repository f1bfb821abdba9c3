#include "embree_side.hpp"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

#include "embree_calls.hpp"

namespace raymill::bench {

namespace {

bool count_bytes(void* bytes, std::ptrdiff_t more, bool) {
    *static_cast<std::atomic<std::ptrdiff_t>*>(bytes) += more;
    return true;
}

[[noreturn]] void fail(void*, RTCError code, const char* message) {
    throw std::runtime_error(fmt::format("Embree: error {}: {}", static_cast<int>(code), message));
}

struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Geometry = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

/// What Embree is told of the rays.
RTCIntersectContext context_for(bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

/// Packed once, and shared by every variant of the same call.
template <class Call>
using PackedRays = std::shared_ptr<const std::vector<typename Call::Rays>>;

/// The hierarchy that variants trace in.
struct Target {
    RTCScene scene;
    std::string suffix;  // of the variants' names
    std::uint32_t sphere_offset;
};

template <class Call>
Variant closest_variant(const Target& target, const PackedRays<Call>& rays, std::size_t count, bool coherent) {
    const auto hits = std::make_shared<std::vector<typename Call::Hits>>(rays->size());
    const auto trace = [=] {
        for_chunks(rays->size() * Call::width, [&](std::size_t first, std::size_t end) {
            RTCIntersectContext context = context_for(coherent);
            Call::closest(target.scene, context, target.sphere_offset, rays->data() + first / Call::width,
                          (end - first) / Call::width, hits->data() + first / Call::width);
        });
    };
    const auto found = [hits, count] {
        std::vector<std::uint32_t> ids(count);
        for (std::size_t i = 0; i < count; ++i) ids[i] = (*hits)[i / Call::width].primitive[i % Call::width];
        return ids;
    };
    return {Call::name(coherent) + target.suffix, false, trace, found};
}

template <class Call>
Variant any_variant(const Target& target, const PackedRays<Call>& rays, std::size_t count, bool coherent) {
    const auto blocked = std::make_shared<std::vector<std::uint8_t>>(rays->size() * Call::width);
    const auto trace = [=] {
        for_chunks(rays->size() * Call::width, [&](std::size_t first, std::size_t end) {
            RTCIntersectContext context = context_for(coherent);
            Call::any(target.scene, context, rays->data() + first / Call::width, (end - first) / Call::width,
                      blocked->data() + first);
        });
    };
    const auto found = [blocked, count] {
        return std::vector<std::uint32_t>(blocked->begin(), blocked->begin() + static_cast<std::ptrdiff_t>(count));
    };
    return {Call::name(coherent) + target.suffix, false, trace, found};
}

template <class Call>
void add_variants(std::vector<Variant>& variants, std::span<const Target> targets, const RaySet& set) {
    const auto rays = std::make_shared<const std::vector<typename Call::Rays>>(pack_rays<Call>(set.rays));
    for (const Target& target : targets)
        for (const bool coherent : {true, false})
            variants.push_back(set.any_hit ? any_variant<Call>(target, rays, set.rays.size(), coherent)
                                           : closest_variant<Call>(target, rays, set.rays.size(), coherent));
}

}  // namespace

const char* name_of(Quality quality) {
    return quality == Quality::medium ? "medium" : "high";
}

EmbreeSide::EmbreeSide(const Scene& scene, unsigned threads, bool robust)
    : scene_(scene),
      robust_(robust),
      device_(rtcNewDevice(threads > 0 ? fmt::format("threads={}", threads).c_str() : nullptr)) {
    if (!device_) throw std::runtime_error("Embree: no device");
    rtcSetDeviceErrorFunction(device_.get(), fail, nullptr);
    rtcSetDeviceMemoryMonitorFunction(device_.get(), count_bytes, &bytes_);
    for (const Sphere& s : scene.spheres) spheres_.emplace_back(s.center[0], s.center[1], s.center[2], s.radius);
}

void EmbreeSide::attach_triangles(RTCScene scene, RTCFilterFunctionN occluded_filter) const {
    if (scene_.triangles.empty()) return;
    const Geometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene_.vertices.data(), 0,
                               sizeof(Vertex), scene_.vertices.size());
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene_.triangles.data(), 0,
                               sizeof(Triangle), scene_.triangles.size());
    rtcSetGeometryOccludedFilterFunction(geometry.get(), occluded_filter);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene, geometry.get(), EMBREE_TRIANGLES);
}

void EmbreeSide::attach_spheres(RTCScene scene, RTCFilterFunctionN occluded_filter) const {
    if (scene_.spheres.empty()) return;
    const Geometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, spheres_.data(), 0,
                               sizeof(glm::vec4), spheres_.size());
    rtcSetGeometryOccludedFilterFunction(geometry.get(), occluded_filter);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene, geometry.get(), EMBREE_SPHERES);
}

Build EmbreeSide::build(Quality quality, RTCFilterFunctionN occluded_filter) {
    std::erase_if(built_, [&](const Hierarchy& h) { return h.quality == quality; });
    const std::ptrdiff_t before = bytes_;
    const auto start = std::chrono::steady_clock::now();
    Hierarchy made{quality, decltype(Hierarchy::scene)(rtcNewScene(device_.get()))};
    rtcSetSceneFlags(made.scene.get(), robust_ ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(made.scene.get(),
                            quality == Quality::medium ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_HIGH);
    attach_triangles(made.scene.get(), occluded_filter);
    attach_spheres(made.scene.get(), occluded_filter);
    rtcCommitScene(made.scene.get());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    built_.push_back(std::move(made));
    // Its leaves copy triangles, but only name spheres, which rays then read from our array.
    const std::size_t sphere_bytes = spheres_.size() * sizeof(glm::vec4);
    return {took.count(), static_cast<std::size_t>(bytes_ - before) + sphere_bytes};
}

std::vector<CameraHit> EmbreeSide::closest_hits(std::span<const BenchRay> rays) const {
    std::vector<CameraHit> hits(rays.size());
    const auto sphere_offset = static_cast<std::uint32_t>(scene_.triangles.size());
    for_chunks(rays.size(), [&](std::size_t first, std::size_t end) {
        RTCIntersectContext context = context_for(false);
        for (std::size_t i = first; i < end; ++i) {
            RTCRayHit query = query_of(ray_of(rays[i]));
            rtcIntersect1(scene(), &context, &query);
            hits[i] = {primitive_of(query.hit.geomID, query.hit.primID, sphere_offset), query.ray.tfar, query.hit.u,
                       query.hit.v};
        }
    });
    return hits;
}

std::vector<Variant> EmbreeSide::variants(const RaySet& set) const {
    const auto has = [&](RTCDeviceProperty property) { return rtcGetDeviceProperty(device_.get(), property) != 0; };
    const auto sphere_offset = static_cast<std::uint32_t>(scene_.triangles.size());
    std::vector<Target> targets;
    for (const Hierarchy& h : built_)
        targets.push_back({h.scene.get(), h.quality == Quality::medium ? "" : ", high", sphere_offset});
    std::vector<Variant> variants;
    add_variants<SingleCall>(variants, targets, set);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED)) add_variants<PacketCall4>(variants, targets, set);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) add_variants<PacketCall8>(variants, targets, set);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) add_variants<PacketCall16>(variants, targets, set);
    if (has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED)) {
        add_variants<StreamCall>(variants, targets, set);
        if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) add_variants<PacketStreamCall>(variants, targets, set);
    }
    return variants;
}

}  // namespace raymill::bench
