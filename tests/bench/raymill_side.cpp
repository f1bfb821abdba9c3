#include "raymill_side.hpp"

#include <chrono>

namespace raymill::bench {

namespace {

void store(float (&to)[3], const glm::vec3& from) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

std::vector<Ray> ray_queue(const RaySet& set) {
    std::vector<Ray> queue(set.rays.size());
    for (std::size_t i = 0; i < queue.size(); ++i) {
        store(queue[i].origin, set.rays[i].origin);
        store(queue[i].direction, set.rays[i].direction);
        queue[i].route = ROUTE_REFLECTED;  // a hit of such a ray adds nothing to the film
    }
    return queue;
}

/// Segments of CHUNK rays, filled as far as the set says.
std::vector<ShadowRay> shadow_queue(const RaySet& set) {
    std::vector<ShadowRay> queue(set.segments.size() * CHUNK);
    std::size_t next = 0;
    for (std::size_t segment = 0; segment < set.segments.size(); ++segment)
        for (uint k = 0; k < set.segments[segment]; ++k, ++next) {
            ShadowRay& ray = queue[segment * CHUNK + k];
            store(ray.origin, set.rays[next].origin);
            store(ray.direction, set.rays[next].direction);
            ray.t_max = set.rays[next].t_max;
            ray.pixel = static_cast<uint>(next);
            ray.diffuse[0] = 1;
            ray.route = ROUTE_CAMERA;
        }
    return queue;
}

std::string name_of(Traversal traversal) {
    if (traversal == Traversal::automatic) return AUTOMATIC;
    return traversal == Traversal::packet ? "raymill packet" : "raymill single";
}

Film film_of(const Device& device, std::size_t pixels) {
    Film film{{device, pixels * FILM_CHANNELS}, {device, 1}, true};
    film.sums.clear(device);
    film.counters.clear(device);
    device.queue.finish();
    return film;
}

}  // namespace

Build RaymillHierarchy::build() {
    bvh_ = {};
    const auto start = std::chrono::steady_clock::now();
    bvh_ = build_bvh(scene_.vertices, scene_.triangles, scene_.spheres, options_);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    return {took.count(), bvh_.nodes.size() * sizeof(BvhNode) + bvh_.triangle_blocks.size() * sizeof(TriangleBlock) +
                              bvh_.sphere_blocks.size() * sizeof(SphereBlock)};
}

RaymillKernels::RaymillKernels(const std::string& device, unsigned threads, const std::vector<Traversal>& traversals)
    : device_(open_device(device, threads)) {
    for (const Traversal traversal : traversals)
        kinds_.push_back({name_of(traversal), std::make_unique<Stages>(device_, 0, "", traversal)});
}

std::vector<Variant> RaymillSide::variants(const RaySet& set) {
    return set.any_hit ? shadow_variants(set) : closest_variants(set);
}

std::vector<Variant> RaymillSide::closest_variants(const RaySet& set) {
    struct Queues {
        Buffer<Ray> rays;
        Buffer<Hit> hits;
        Film film;
    };
    const Device& device = kernels_.device();
    const std::vector<Ray> rays = ray_queue(set);
    const auto queues = std::make_shared<Queues>(
        Queues{{device, std::span<const Ray>(rays)}, {device, rays.size()}, film_of(device, 1)});
    std::vector<Variant> variants;
    for (const RaymillKernels::Kind& kind : kernels_.kinds()) {
        const auto trace = [this, queues, stages = kind.stages.get()] {
            stages->intersect(scene_, {queues->rays, 0, static_cast<uint>(queues->rays.size())}, queues->hits,
                              queues->film);
            kernels_.device().queue.finish();
        };
        const auto found = [this, queues] {
            std::vector<std::uint32_t> ids;
            for (const Hit& hit : queues->hits.read(kernels_.device())) ids.push_back(hit.primitive);
            return ids;
        };
        variants.push_back({kind.name, true, trace, found});
    }
    return variants;
}

std::vector<Variant> RaymillSide::shadow_variants(const RaySet& set) {
    struct Queues {
        ShadowQueue rays;
        Film film;
    };
    const Device& device = kernels_.device();
    const std::vector<ShadowRay> rays = shadow_queue(set);
    const auto queues = std::make_shared<Queues>(
        Queues{{{device, std::span<const ShadowRay>(rays)}, {device, std::span<const uint>(set.segments)}},
               film_of(device, set.rays.size())});
    std::vector<Variant> variants;
    for (const RaymillKernels::Kind& kind : kernels_.kinds()) {
        const auto trace = [this, queues, stages = kind.stages.get()] {
            stages->shadow(scene_, queues->rays, static_cast<uint>(queues->rays.counts.size()), queues->film);
            kernels_.device().queue.finish();
        };
        const auto found = [this, queues] {
            std::vector<std::uint32_t> blocked;
            const std::vector<cl_long> sums = queues->film.sums.read(kernels_.device());
            for (std::size_t i = 0; i < sums.size(); i += FILM_CHANNELS) blocked.push_back(sums[i] == 0);
            // The next variant's flags must be its own.
            queues->film.sums.clear(kernels_.device());
            kernels_.device().queue.finish();
            return blocked;
        };
        variants.push_back({kind.name, true, trace, found});
    }
    return variants;
}

}  // namespace raymill::bench
