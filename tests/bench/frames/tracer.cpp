// Source: Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980.
#include "frames/tracer.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include "frames/camera.hpp"
#include "frames/light.hpp"
#include "frames/material.hpp"

namespace raymill::bench {

namespace {

constexpr float light_reach = 1 - 1e-4f;  // a shadow ray ends before the lamp's own surface
constexpr std::uint32_t tile = 16;        // pixels

/// A shadow ray's way through surfaces that let light through. Embree hands the first member to the filter.
struct FilterContext {
    RTCIntersectContext embree;
    const World* world;
    vec3 left;  // of the light
};

std::uint32_t id_of(const Scene& scene, unsigned geometry, unsigned primitive) {
    return geometry == EMBREE_TRIANGLES ? primitive : primitive + static_cast<std::uint32_t>(scene.triangles.size());
}

bool lets_through(const Material& material, vec3& left) {
    left *= material.transmission * vec(material.base_color);
    return left != vec3(0);
}

/// Lets the shadow ray go on where some light is left.
void filter_shadow(const RTCFilterFunctionNArguments* arguments) {
    auto* context = reinterpret_cast<FilterContext*>(arguments->context);
    const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    const Material& material = context->world->material_of(id_of(context->world->scene, hit->geomID, hit->primID));
    if (lets_through(material, context->left)) arguments->valid[0] = 0;
}

RTCRayHit query_of(const vec3& origin, const vec3& direction) {
    RTCRayHit query;
    query.ray = {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0, INFINITY, ~0u, 0, 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

RTCIntersectContext context_for(bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

/// The paths of one thread.
class Paths {
  public:
    Paths(const World& world, RTCScene scene)
        : world_(world), scene_(scene), coherent_(context_for(true)), incoherent_(context_for(false)) {
        filter_.embree = context_for(true);
        filter_.world = &world;
        const SceneConstants& c = world.constants;
        filtered_ = c.shadows == SHADOWS_FILTERED && c.any_filter;
    }

    /// Radiance and coverage that the camera ray brings home.
    glm::vec4 trace(const PathRay& ray) {
        const PathHit hit = closest_hit(ray, coherent_);
        if (hit.primitive == NO_INDEX) return {environment_radiance(world_, ray.direction), 0};
        return {shade(ray, hit, vec3(1), 0), 1};
    }

  private:
    PathHit closest_hit(const PathRay& ray, RTCIntersectContext& context) const;
    vec3 visibility(const vec3& origin, const vec3& direction, float distance);
    vec3 shade(const PathRay& ray, const PathHit& hit, const vec3& throughput, std::uint32_t depth);
    vec3 direct_light(const PathRay& ray, const SurfacePoint& s, const vec3& diffuse);
    vec3 answer(const PathRay& ray, const SurfacePoint& s, const vec3& diffuse, const LightRecord& light,
                const LightPoint& sample) const;
    vec3 gouraud_answer(const PathRay& ray, const SurfacePoint& s, const vec3& diffuse, const LightRecord& light,
                        const LightPoint& sample) const;

    const World& world_;
    RTCScene scene_;
    RTCIntersectContext coherent_, incoherent_;
    FilterContext filter_;
    bool filtered_;
};

PathHit Paths::closest_hit(const PathRay& ray, RTCIntersectContext& context) const {
    RTCRayHit query = query_of(ray.origin, ray.direction);
    rtcIntersect1(scene_, &context, &query);
    PathHit hit;
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
        hit = {query.ray.tfar, query.hit.u, query.hit.v, id_of(world_.scene, query.hit.geomID, query.hit.primID)};
    for (std::size_t i = 0; i < world_.scene.planes.size(); ++i) {
        const Plane& plane = world_.scene.planes[i];
        const vec3 normal = vec(plane.normal);
        const float t = -glm::dot(normal, ray.origin - vec(plane.point)) / glm::dot(normal, ray.direction);
        if (t > 0 && t < hit.t)
            hit = {t, 0, 0,
                   static_cast<std::uint32_t>(world_.scene.triangles.size() + world_.scene.spheres.size() + i)};
    }
    return hit;
}

vec3 Paths::visibility(const vec3& origin, const vec3& direction, float distance) {
    vec3 left(1);
    for (const Plane& plane : world_.scene.planes) {
        const vec3 normal = vec(plane.normal);
        const float t = -glm::dot(normal, origin - vec(plane.point)) / glm::dot(normal, direction);
        if (!(t > 0 && t < distance)) continue;
        if (!filtered_ || !lets_through(world_.materials[plane.material], left)) return vec3(0);
    }
    RTCRay ray = query_of(origin, direction).ray;
    ray.tfar = distance;
    filter_.left = left;
    rtcOccluded1(scene_, filtered_ ? &filter_.embree : &coherent_, &ray);
    return ray.tfar < 0 ? vec3(0) : filter_.left;
}

/// Phong's formula at the three vertices, the results interpolated. An area light's I_in is that at the hit.
vec3 Paths::gouraud_answer(const PathRay& ray, const SurfacePoint& s, const vec3& diffuse, const LightRecord& light,
                           const LightPoint& sample) const {
    const bool smooth = has_normals(world_.scene, *s.triangle);
    vec3 sum(0);
    for (int corner = 0; corner < 3; ++corner) {
        const Vertex& vertex = world_.scene.vertices[s.triangle->vertex[corner]];
        const vec3 p = vec(vertex.position);
        const vec3 n = smooth ? (s.inside ? -1.0f : 1.0f) * glm::normalize(vec(vertex.normal)) : s.geometric;
        LightPoint at_vertex = sample;
        if (light.type == LIGHT_POINT || light.type == LIGHT_SPOT)
            shine_from_position(light, p, at_vertex);
        else if (light.type != LIGHT_DIRECTIONAL)
            at_vertex.direction = glm::normalize(sample.position - p);
        const vec3 to_eye = ray.origin != p ? glm::normalize(ray.origin - p) : -ray.direction;
        const vec2 terms = phong_terms(*s.material, n, at_vertex.direction, to_eye);
        if (terms.x > 0)
            sum += s.weights[corner] * (terms.x * diffuse + terms.y * vec(s.material->specular)) * at_vertex.incoming;
    }
    return sum;
}

vec3 Paths::answer(const PathRay& ray, const SurfacePoint& s, const vec3& diffuse, const LightRecord& light,
                   const LightPoint& sample) const {
    if (s.triangle && (s.material->flags & MATERIAL_GOURAUD)) return gouraud_answer(ray, s, diffuse, light, sample);
    const vec2 terms = phong_terms(*s.material, s.shading, sample.direction, -ray.direction);
    return (terms.x * diffuse + terms.y * vec(s.material->specular)) * sample.incoming;
}

vec3 Paths::direct_light(const PathRay& ray, const SurfacePoint& s, const vec3& diffuse) {
    const bool none = world_.constants.shadows == SHADOWS_NONE;
    const bool lifted = s.smooth && world_.constants.robust_offset;
    vec3 origin = leave(world_, s, 1);
    if (lifted) origin += smooth_lift(world_, s);
    vec3 sum(0);
    for (const LightSlot& slot : world_.slots) {
        const LightRecord& light = world_.lights[slot.light];
        LightPoint sample = sample_light(light, slot, s.position, ray);
        if ((!s.smooth || none) && !(glm::dot(sample.direction, s.geometric) > 0)) continue;
        const vec3 radiance = answer(ray, s, diffuse, light, sample);
        if (radiance == vec3(0)) continue;
        if (none) {
            sum += radiance;
            continue;
        }
        if (lifted && light.type != LIGHT_DIRECTIONAL) {
            const vec3 to_light = sample.position - origin;
            sample.distance = glm::length(to_light);
            sample.direction = to_light / sample.distance;
        }
        sum += radiance * visibility(origin, sample.direction, sample.distance * light_reach);
    }
    return sum;
}

vec3 Paths::shade(const PathRay& ray, const PathHit& hit, const vec3& throughput, std::uint32_t depth) {
    const SurfacePoint s = surface_at(world_, ray, hit);
    const Material& m = *s.material;
    const vec3 absorbed = absorption(s, hit.t);
    const float local = std::max(1 - m.reflection - m.transmission, 0.0f);
    vec3 sum(0);
    if (!s.inside || !(m.flags & MATERIAL_ONE_SIDED)) sum += vec(m.emission);
    if (local > 0) {
        sum += local * vec(m.ambient) * vec(world_.constants.ambient);
        const vec3 diffuse = diffuse_color(world_, s);
        if (diffuse + vec(m.specular) != vec3(0)) sum += local * direct_light(ray, s, diffuse);
    }
    if (depth >= static_cast<std::uint32_t>(world_.scene.settings.depth) || !(m.reflection + m.transmission > 0))
        return absorbed * sum;

    const RaySplit split = split_ray(s, ray.direction);
    const auto add_child = [&](float share, float side, const vec3& direction, std::uint32_t branch) {
        const vec3 color = share * vec(m.base_color), child = throughput * absorbed * color;
        const float strongest = std::max({child.x, child.y, child.z});
        if (strongest == 0 || strongest < world_.constants.min_weight) return;
        const PathRay next{leave(world_, s, side), direction, path_child(ray.path, branch), ray.sample};
        const PathHit found = closest_hit(next, incoherent_);
        sum += color * (found.primitive == NO_INDEX ? environment_radiance(world_, direction)
                                                    : shade(next, found, child, depth + 1));
    };
    add_child(split.reflection, 1, split.reflected, 0);
    add_child(split.transmission, -1, split.refracted, 1);
    return absorbed * sum;
}

void render_tile(const World& world, RTCScene scene, std::uint32_t index, float* rgba) {
    const auto [x0, y0, width, height] = world.camera.crop;
    const std::uint32_t columns = (width + tile - 1) / tile;
    const std::uint32_t left = index % columns * tile, top = index / columns * tile;
    Paths paths(world, scene);
    for (std::uint32_t y = top; y < std::min(top + tile, height); ++y)
        for (std::uint32_t x = left; x < std::min(left + tile, width); ++x) {
            glm::vec4 sum(0);
            for (std::uint32_t sample = 0; sample < world.camera.spp; ++sample)
                sum += paths.trace(camera_ray(world.camera, x0 + x, y0 + y, sample));
            sum /= static_cast<float>(world.camera.spp);
            std::copy_n(&sum.x, 4, rgba + 4 * (std::size_t{y} * width + x));
        }
}

}  // namespace

EmbreeTracer::EmbreeTracer(const Scene& scene, unsigned threads) : world_(scene), embree_(scene, threads, false) {
    // A split triangle would be met, and filter the light, more than once: medium quality splits none.
    embree_.build(Quality::medium, world_.constants.any_filter ? filter_shadow : nullptr);
}

std::vector<float> EmbreeTracer::render() const {
    const std::uint32_t width = world_.camera.crop[2], height = world_.camera.crop[3];
    std::vector<float> rgba(std::size_t{4} * width * height);
    const std::uint32_t tiles = ((width + tile - 1) / tile) * ((height + tile - 1) / tile);
    const auto run = [&](const tbb::blocked_range<std::uint32_t>& range) {
        const unsigned control = _mm_getcsr();
        _mm_setcsr(control | 0x8040);  // flush to zero, denormals are zero, as Embree's manual asks
        for (std::uint32_t i = range.begin(); i < range.end(); ++i)
            render_tile(world_, embree_.scene(), i, rgba.data());
        _mm_setcsr(control);
    };
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, tiles, 1), run, tbb::simple_partitioner());
    return rgba;
}

}  // namespace raymill::bench
