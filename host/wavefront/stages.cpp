#include "wavefront/stages.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "device/program.hpp"

namespace raymill {

namespace {

const std::vector<std::string> kernel_files = {"generate.cl", "intersect.cl", "shade.cl",
                                               "shadow.cl",   "secondary.cl", "resolve.cl"};

// Kernels of one item a work-item want groups that fill the vector units; those that loop over a chunk want none
// (PoCL replicates their stacks for each work-item of a group).
constexpr std::size_t item_group = 64;
constexpr std::size_t chunk_group = 1;

template <class T>
const cl::Buffer& argument(const Buffer<T>& buffer) {
    return buffer.memory();
}
uint argument(uint value) {
    return value;
}
uint argument(bool value) {
    return value;
}
cl_ulong argument(std::uint64_t value) {
    return value;
}

uint film_flags(const Film& film) {
    return (film.pixels_once ? FILM_PIXELS_ONCE : 0) | (film.counted ? FILM_COUNTED : 0) | film.pass << FILM_PASS_SHIFT;
}

}  // namespace

std::uint64_t atomics_of(const Counters& counters, profile::Stage stage) {
    switch (stage) {
        case profile::Stage::intersect:
            return counters.atomics[ATOMICS_INTERSECT];
        case profile::Stage::shade:
            return counters.atomics[ATOMICS_SHADE];
        case profile::Stage::shadow:
            return counters.atomics[ATOMICS_SHADOW];
        case profile::Stage::features:
            return counters.atomics[ATOMICS_FEATURES];
        case profile::Stage::secondary:
            return counters.atomics[ATOMICS_SECONDARY];
        case profile::Stage::generate:
        case profile::Stage::resolve:
            break;
    }
    return 0;
}

Stages::Stages(const Device& device, std::size_t work_group, const std::string& kernel_dir, Traversal traversal)
    : device_(device),
      work_group_(work_group),
      kernel_dir_(kernel_dir),
      packets_(traversal == Traversal::packet || (traversal == Traversal::automatic && device.info.type == "CPU")),
      queue_(device.queue) {
    if (work_group > device.info.largest_work_group)
        throw DeviceError(fmt::format("device {} has work-groups of at most {} items, not {}: lower --work-group",
                                      device.info.name, device.info.largest_work_group, work_group));
    const cl::Program program = build(kernel_files);
    const auto item_stage = [&](profile::Stage name, std::size_t group) {
        return Stage{name, make_kernel(program, profile::stage_name(name).data()), work_group > 0 ? work_group : group,
                     1};
    };
    // One ray a work-item, on processors still without company: their stacks are replicated like those of chunks.
    const auto ray_stage = [&](profile::Stage name) {
        return packets_ ? chunk_stage(program, name)
                        : item_stage(name, device.info.type == "CPU" ? chunk_group : item_group);
    };
    generate_ = chunk_stage(program, profile::Stage::generate);
    intersect_ = ray_stage(profile::Stage::intersect);
    shade_ = chunk_stage(program, profile::Stage::shade);
    shadow_ = ray_stage(profile::Stage::shadow);
    secondary_ = chunk_stage(program, profile::Stage::secondary);
    if (packets_) secondary_.items = FAMILY;
    resolve_ = item_stage(profile::Stage::resolve, item_group);
}

cl::Program Stages::build(const std::vector<std::string>& files) const {
    return build_program(device_, files, kernel_dir_, packets_ ? "-DRAYMILL_PACKETS" : "");
}

Stages::Stage Stages::chunk_stage(const cl::Program& program, profile::Stage name) const {
    return {name, make_kernel(program, profile::stage_name(name).data()), work_group_ > 0 ? work_group_ : chunk_group,
            CHUNK};
}

void Stages::build_features() {
    if (!features_) features_ = chunk_stage(build({"features.cl"}), profile::Stage::features);
}

template <class... Arguments>
void Stages::launch(Stage& stage, const Work& work, const Arguments&... arguments) {
    if (work.work_items == 0 && !runs_empty_launches_) return;
    try {
        cl_uint index = 0;
        (stage.kernel.setArg(index++, argument(arguments)), ...);
        const std::size_t groups = (std::max(work.work_items, 1u) + stage.local_size - 1) / stage.local_size;
        cl::Event event;
        queue_.enqueueNDRangeKernel(stage.kernel, cl::NullRange, cl::NDRange(groups * stage.local_size),
                                    cl::NDRange(stage.local_size), nullptr, observer_ ? &event : nullptr);
        if (observer_) {
            const std::uint64_t places = std::uint64_t{groups} * stage.local_size * stage.items;
            observer_({stage.name, work.items, work.work_items, groups, places, work.segments}, event);
        }
    } catch (const cl::Error& error) {
        throw DeviceError(fmt::format("kernel {}: {} failed: {} ({})", profile::stage_name(stage.name), error.what(),
                                      status_name(error.err()), error.err()));
    }
}

void Stages::generate(const DeviceScene& scene, std::uint64_t first_sample, uint count, Buffer<Ray>& rays) {
    launch(generate_, {chunks(count), count}, first_sample, count, scene.camera, rays);
}

void Stages::intersect(const DeviceScene& scene, QueueRange<Ray> rays, Buffer<Hit>& hits, Film& film) {
    launch(intersect_, {intersect_.work_items(rays.count), rays.count}, rays.items, rays.first, rays.count, scene.nodes,
           scene.triangle_blocks, scene.sphere_blocks, scene.planes, scene.textures, scene.texels, scene.constants,
           hits, film.sums, film.counters, film_flags(film));
}

void Stages::shade(const DeviceScene& scene, QueueRange<Ray> rays, const Buffer<Hit>& hits, SlotRange slots,
                   ShadowQueue& shadow_rays, Film& film) {
    launch(shade_, {chunks(rays.count), rays.count, chunks(rays.count) * slots.count}, rays.items, rays.first,
           rays.count, hits, slots.first, slots.count, scene.light_slots, scene.lights, scene.vertices, scene.triangles,
           scene.spheres, scene.planes, scene.materials, scene.textures, scene.texels, scene.constants,
           shadow_rays.rays, shadow_rays.counts, film.sums, film.counters, film_flags(film));
}

void Stages::features(const DeviceScene& scene, QueueRange<Ray> rays, uint depth, const Buffer<Hit>& hits, Film& film) {
    build_features();
    launch(*features_, {chunks(rays.count), rays.count}, rays.items, rays.first, rays.count, depth, hits,
           scene.vertices, scene.triangles, scene.spheres, scene.planes, scene.materials, scene.textures, scene.texels,
           scene.camera, scene.constants, film.sums, film.counters, film_flags(film));
}

void Stages::shadow(const DeviceScene& scene, const ShadowQueue& shadow_rays, uint segments, Film& film) {
    launch(shadow_, {segments * (CHUNK / shadow_.items), segments * CHUNK, segments}, shadow_rays.rays,
           shadow_rays.counts, segments, scene.nodes, scene.triangle_blocks, scene.sphere_blocks, scene.planes,
           scene.triangles, scene.spheres, scene.materials, scene.constants, film.sums, film.counters,
           film_flags(film));
}

void Stages::secondary(const DeviceScene& scene, QueueRange<Ray> rays, const Buffer<Hit>& hits, QueueEnd<Ray> children,
                       Film& film) {
    const uint capacity = static_cast<uint>(children.items.size()) - children.first;
    launch(secondary_, {secondary_.work_items(rays.count), rays.count}, rays.items, rays.first, rays.count, hits,
           scene.vertices, scene.triangles, scene.spheres, scene.planes, scene.materials, scene.textures, scene.texels,
           scene.constants, children.items, children.first, capacity, film.counters, film.counted);
}

void Stages::resolve(const Film& film, uint spp, Buffer<float>& pixels) {
    const uint count = static_cast<uint>(pixels.size());
    launch(resolve_, {count, count}, film.sums, count, spp, pixels);
}

}  // namespace raymill
