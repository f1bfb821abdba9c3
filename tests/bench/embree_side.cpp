#include "embree_side.hpp"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

#include "embree_calls.hpp"

namespace raymill::bench {

namespace {

constexpr unsigned triangles_id = 0;
constexpr unsigned spheres_id = 1;

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

template <class Call>
Variant closest_variant(RTCScene scene, std::uint32_t sphere_offset, const RaySet& set, bool coherent) {
    const auto rays = std::make_shared<const std::vector<typename Call::Rays>>(pack_rays<Call>(set.rays));
    const auto hits = std::make_shared<std::vector<typename Call::Hits>>(rays->size());
    const auto trace = [=] {
        for_chunks(rays->size() * Call::width, [&](std::size_t first, std::size_t end) {
            RTCIntersectContext context = context_for(coherent);
            Call::closest(scene, context, sphere_offset, rays->data() + first / Call::width,
                          (end - first) / Call::width, hits->data() + first / Call::width);
        });
    };
    const auto found = [hits, count = set.rays.size()] {
        std::vector<std::uint32_t> ids(count);
        for (std::size_t i = 0; i < count; ++i) ids[i] = (*hits)[i / Call::width].primitive[i % Call::width];
        return ids;
    };
    return {Call::name(coherent), false, trace, found};
}

template <class Call>
Variant any_variant(RTCScene scene, const RaySet& set, bool coherent) {
    const auto rays = std::make_shared<const std::vector<typename Call::Rays>>(pack_rays<Call>(set.rays));
    const auto blocked = std::make_shared<std::vector<std::uint8_t>>(rays->size() * Call::width);
    const auto trace = [=] {
        for_chunks(rays->size() * Call::width, [&](std::size_t first, std::size_t end) {
            RTCIntersectContext context = context_for(coherent);
            Call::any(scene, context, rays->data() + first / Call::width, (end - first) / Call::width,
                      blocked->data() + first);
        });
    };
    const auto found = [blocked, count = static_cast<std::ptrdiff_t>(set.rays.size())] {
        return std::vector<std::uint32_t>(blocked->begin(), blocked->begin() + count);
    };
    return {Call::name(coherent), false, trace, found};
}

template <class Call>
void add_variants(std::vector<Variant>& variants, RTCScene scene, std::uint32_t sphere_offset, const RaySet& set) {
    for (const bool coherent : {true, false})
        variants.push_back(set.any_hit ? any_variant<Call>(scene, set, coherent)
                                       : closest_variant<Call>(scene, sphere_offset, set, coherent));
}

}  // namespace

EmbreeSide::EmbreeSide(const Scene& scene, unsigned threads, RTCBuildQuality quality, bool robust)
    : scene_(scene),
      quality_(quality),
      robust_(robust),
      device_(rtcNewDevice(threads > 0 ? fmt::format("threads={}", threads).c_str() : nullptr)) {
    if (!device_) throw std::runtime_error("Embree: no device");
    rtcSetDeviceErrorFunction(device_.get(), fail, nullptr);
    rtcSetDeviceMemoryMonitorFunction(device_.get(), count_bytes, &bytes_);
    for (const Sphere& s : scene.spheres) spheres_.emplace_back(s.center[0], s.center[1], s.center[2], s.radius);
}

void EmbreeSide::attach_triangles(RTCScene scene) const {
    if (scene_.triangles.empty()) return;
    const Geometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene_.vertices.data(), 0,
                               sizeof(Vertex), scene_.vertices.size());
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene_.triangles.data(), 0,
                               sizeof(Triangle), scene_.triangles.size());
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene, geometry.get(), triangles_id);
}

void EmbreeSide::attach_spheres(RTCScene scene) const {
    if (scene_.spheres.empty()) return;
    const Geometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, spheres_.data(), 0,
                               sizeof(glm::vec4), spheres_.size());
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene, geometry.get(), spheres_id);
}

Build EmbreeSide::build() {
    built_.reset();
    const std::ptrdiff_t before = bytes_;
    const auto start = std::chrono::steady_clock::now();
    built_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(built_.get(), robust_ ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(built_.get(), quality_);
    attach_triangles(built_.get());
    attach_spheres(built_.get());
    rtcCommitScene(built_.get());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    return {took.count(), static_cast<std::size_t>(bytes_ - before)};
}

std::vector<CameraHit> EmbreeSide::closest_hits(std::span<const BenchRay> rays) const {
    std::vector<CameraHit> hits(rays.size());
    const auto sphere_offset = static_cast<std::uint32_t>(scene_.triangles.size());
    for_chunks(rays.size(), [&](std::size_t first, std::size_t end) {
        RTCIntersectContext context = context_for(false);
        for (std::size_t i = first; i < end; ++i) {
            RTCRayHit query = query_of(ray_of(rays[i]));
            rtcIntersect1(built_.get(), &context, &query);
            hits[i] = {primitive_of(query.hit.geomID, query.hit.primID, sphere_offset), query.ray.tfar, query.hit.u,
                       query.hit.v};
        }
    });
    return hits;
}

std::vector<Variant> EmbreeSide::variants(const RaySet& set) const {
    const auto has = [&](RTCDeviceProperty property) { return rtcGetDeviceProperty(device_.get(), property) != 0; };
    const auto sphere_offset = static_cast<std::uint32_t>(scene_.triangles.size());
    std::vector<Variant> variants;
    add_variants<SingleCall>(variants, built_.get(), sphere_offset, set);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED))
        add_variants<PacketCall8>(variants, built_.get(), sphere_offset, set);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
        add_variants<PacketCall16>(variants, built_.get(), sphere_offset, set);
    if (has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED))
        add_variants<StreamCall>(variants, built_.get(), sphere_offset, set);
    return variants;
}

}  // namespace raymill::bench
