#include "raymill_side.hpp"

#include <chrono>
#include <filesystem>

#include "device/program.hpp"

namespace raymill::bench {

namespace {

constexpr const char* STAGE = ", stage";

/// Closest hits leave the film alone; misses add a black background to its one pixel.
struct Queues {
    Buffer<Ray> rays;
    Buffer<Hit> hits;
    Film film;
};

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

RaymillKernels::RaymillKernels(const std::string& device, unsigned threads, const std::vector<Traversal>& traversals,
                               const std::vector<std::string>& folders)
    : device_(open_device(device, threads)) {
    for (const Traversal traversal : traversals) {
        add(traversal, "", name_of(traversal));
        for (const std::string& folder : folders) add(traversal, folder, name_of(traversal) + " " + folder);
    }
}

void RaymillKernels::add(Traversal traversal, const std::string& folder, const std::string& name) {
    const bool packets =
        traversal == Traversal::packet || (traversal == Traversal::automatic && device_.info.type == "CPU");
    const std::string library = folder.empty() ? RAYMILL_KERNELS : folder;
    const std::string file = std::filesystem::relative(RAYMILL_KERNELS "/../tests/bench/traversal.cl", library);
    const cl::Program program = build_program(device_, {file}, library, packets ? "-DRAYMILL_PACKETS" : "");
    kinds_.push_back({name, std::make_unique<Stages>(device_, 0, folder, traversal), make_kernel(program, "closest"),
                      make_kernel(program, "occlusion"), packets ? std::size_t{CHUNK} : 1});
}

std::vector<Variant> RaymillSide::variants(const RaySet& set) {
    return set.any_hit ? shadow_variants(set) : closest_variants(set);
}

std::vector<Variant> RaymillSide::closest_variants(const RaySet& set) {
    const Device& device = kernels_.device();
    const std::vector<Ray> rays = ray_queue(set);
    const auto queues = std::make_shared<Queues>(
        Queues{{device, std::span<const Ray>(rays)}, {device, rays.size()}, film_of(device, 1)});
    const auto found = [this, queues] {
        std::vector<std::uint32_t> ids;
        for (const Hit& hit : queues->hits.read(kernels_.device())) ids.push_back(hit.primitive);
        return ids;
    };
    const auto count = static_cast<uint>(rays.size());
    std::vector<Variant> variants;
    for (const RaymillKernels::Kind& kind : kernels_.kinds()) {
        const auto alone = [this, queues, count, kernel = kind.closest, share = kind.rays_a_work_item]() mutable {
            run(kernel, (count + share - 1) / share, queues->rays.memory(), count, scene_.nodes.memory(),
                scene_.triangle_blocks.memory(), scene_.sphere_blocks.memory(), scene_.planes.memory(),
                scene_.constants.memory(), queues->hits.memory());
        };
        const auto stage = [this, queues, count, stages = kind.stages.get()] {
            stages->intersect(scene_, {queues->rays, 0, count}, queues->hits, queues->film);
            kernels_.device().queue.finish();
        };
        variants.push_back({kind.name, true, alone, found});
        variants.push_back({kind.name + STAGE, true, stage, found});
    }
    return variants;
}

template <typename... Arguments>
void RaymillSide::run(cl::Kernel& kernel, std::size_t work_items, const Arguments&... arguments) const {
    cl_uint index = 0;
    (kernel.setArg(index++, arguments), ...);
    const cl::CommandQueue& queue = kernels_.device().queue;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(work_items), cl::NDRange(1));
    queue.finish();
}

std::vector<Variant> RaymillSide::shadow_variants(const RaySet& set) {
    const Device& device = kernels_.device();
    const std::vector<ShadowRay> rays = shadow_queue(set);
    const auto queue = std::make_shared<ShadowQueue>(
        ShadowQueue{{device, std::span<const ShadowRay>(rays)}, {device, std::span<const uint>(set.segments)}});
    std::vector<Variant> variants;
    for (const RaymillKernels::Kind& kind : kernels_.kinds()) {
        variants.push_back(occlusion_variant(kind, queue));
        variants.push_back(shadow_variant(kind, queue, set.rays.size()));
    }
    return variants;
}

Variant RaymillSide::occlusion_variant(const RaymillKernels::Kind& kind, std::shared_ptr<ShadowQueue> rays) {
    const Device& device = kernels_.device();
    const auto blocked = std::make_shared<Buffer<cl_uchar>>(device, rays->rays.size());
    const auto trace = [this, rays, blocked, kernel = kind.occlusion, share = kind.rays_a_work_item]() mutable {
        run(kernel, rays->rays.size() / share, rays->rays.memory(), rays->counts.memory(),
            static_cast<uint>(rays->counts.size()), scene_.nodes.memory(), scene_.triangle_blocks.memory(),
            scene_.sphere_blocks.memory(), scene_.planes.memory(), scene_.constants.memory(), blocked->memory());
    };
    const auto found = [this, rays, blocked] {
        const std::vector<cl_uchar> places = blocked->read(kernels_.device());
        const std::vector<uint> counts = rays->counts.read(kernels_.device());
        std::vector<std::uint32_t> flags;
        for (std::size_t segment = 0; segment < counts.size(); ++segment)
            for (uint i = 0; i < counts[segment]; ++i) flags.push_back(places[segment * CHUNK + i]);
        return flags;
    };
    return {kind.name, true, trace, found};
}

Variant RaymillSide::shadow_variant(const RaymillKernels::Kind& kind, std::shared_ptr<ShadowQueue> rays,
                                    std::size_t count) {
    const auto film = std::make_shared<Film>(film_of(kernels_.device(), count));
    const auto trace = [this, rays, film, stages = kind.stages.get()] {
        stages->shadow(scene_, *rays, static_cast<uint>(rays->counts.size()), *film);
        kernels_.device().queue.finish();
    };
    const auto found = [this, film] {
        std::vector<std::uint32_t> blocked;
        const std::vector<cl_long> sums = film->sums.read(kernels_.device());
        for (std::size_t i = 0; i < sums.size(); i += FILM_CHANNELS) blocked.push_back(sums[i] == 0);
        return blocked;
    };
    return {kind.name + STAGE, true, trace, found};
}

}  // namespace raymill::bench
