#include "kernel_rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>

#include "device/program.hpp"

namespace raymill::test {

namespace {

std::string kernel_folder() {
    const char* folder = std::getenv("RAYMILL_TEST_KERNELS");
    return folder ? folder : "";
}

/// What all tests of a program share. Released when the tests have run, not when statics are: an implementation of
/// OpenCL may have gone by then.
class Shared : public testing::Environment {
  public:
    const Device& device() {
        if (!device_) device_.emplace(open_device("", 0));
        return *device_;
    }
    Stages& stages(Traversal traversal, const std::string& folder) {
        const std::pair key(traversal, folder.empty() ? kernel_folder() : folder);
        if (!stages_.contains(key)) stages_.try_emplace(key, device(), 0, key.second, traversal);
        return stages_.at(key);
    }
    const cl::Program& probe(const std::string& file) {
        const std::string folder = kernel_folder().empty() ? RAYMILL_SOURCE_DIR "/kernels" : kernel_folder();
        if (!probes_.contains(file)) {
            const std::filesystem::path path = RAYMILL_SOURCE_DIR "/tests/kernels/" + file;
            const std::string name_in_folder = std::filesystem::relative(path, folder).string();
            probes_.emplace(file, build_program(device(), {name_in_folder}, folder));
        }
        return probes_.at(file);
    }
    void TearDown() override {
        probes_.clear();
        stages_.clear();
        device_.reset();
    }

  private:
    std::optional<Device> device_;
    std::map<std::pair<Traversal, std::string>, Stages> stages_;  // with the kernels' folder
    std::map<std::string, cl::Program> probes_;
};

// GoogleTest owns it.
Shared* const shared = static_cast<Shared*>(testing::AddGlobalTestEnvironment(std::make_unique<Shared>().release()));

const Device& device() {
    return shared->device();
}

Stages& stages(Traversal traversal = Traversal::automatic, const std::string& folder = "") {
    return shared->stages(traversal, folder);
}

/// An output buffer of the kernel: `capacity` items and the guards.
template <class T>
Buffer<T> guarded(std::size_t capacity) {
    const std::vector<unsigned char> bytes((capacity + GUARD_ITEMS) * sizeof(T), UNTOUCHED);
    std::vector<T> items(capacity + GUARD_ITEMS);
    std::memcpy(static_cast<void*>(items.data()), bytes.data(), bytes.size());
    return Buffer<T>(device(), std::span<const T>(items));
}

template <class T>
Buffer<T> filled(std::span<const T> items) {
    return Buffer<T>(device(), items);
}

/// A film of this many pixels and one more as a guard.
Film cleared_film(std::size_t pixels) {
    Film film{{device(), (pixels + 1) * FILM_CHANNELS}, {device(), 1}};
    film.sums.clear(device());
    film.counters.clear(device());
    return film;
}

/// As many pixels as the items name.
template <class Item>
std::size_t pixels_of(std::span<const Item> items) {
    std::size_t pixels = 1;
    for (const Item& item : items) pixels = std::max<std::size_t>(pixels, item.pixel + 1);
    return pixels;
}

FilmState read(const Film& film) {
    const std::vector<cl_long> sums = film.sums.read(device());
    return {{sums.begin(), sums.end()}, film.counters.read_one(device())};
}

}  // namespace

struct KernelRig::Parts {
    Parts(const Scene& host_scene, Bvh hierarchy, const FilmPlanes& planes = {}, std::size_t film_size = 0)
        : bvh(std::move(hierarchy)), scene(device(), host_scene, bvh, planes), film_pixels(film_size) {}

    Bvh bvh;  // the scene may share its memory
    DeviceScene scene;
    std::size_t film_pixels;  // of all planes; 0: as many as the queue's items name
    Traversal traversal = Traversal::automatic;
    std::string folder;  // of the kernels

    template <class Item>
    Film film_for(std::span<const Item> items) const {
        return cleared_film(film_pixels > 0 ? film_pixels : pixels_of(items));
    }
};

KernelRig::KernelRig(const Scene& scene)
    : KernelRig(scene, build_bvh(scene.vertices, scene.triangles, scene.spheres)) {}

KernelRig::KernelRig(const Scene& scene, const Bvh& bvh) : parts_(std::make_unique<Parts>(scene, bvh)) {}

KernelRig::KernelRig(const Scene& scene, const FilmPlanes& planes) {
    const PixelWindow window = crop_window(scene.settings);
    const auto pixels = static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
    parts_ = std::make_unique<Parts>(scene, build_bvh(scene.vertices, scene.triangles, scene.spheres), planes,
                                     pixels * planes.count());
}

KernelRig::~KernelRig() = default;

void KernelRig::use(Traversal traversal, const std::string& folder) {
    parts_->traversal = traversal;
    parts_->folder = folder;
}

std::vector<Ray> KernelRig::generate(std::uint64_t first_sample, uint count) const {
    Buffer<Ray> rays = guarded<Ray>(count);
    stages().generate(parts_->scene, first_sample, count, rays);
    return rays.read(device());
}

IntersectResult KernelRig::intersect(std::span<const Ray> rays, uint first, bool pixels_once, int launches) const {
    const uint count = static_cast<uint>(rays.size()) - first;
    const Buffer<Ray> queue = filled(rays);
    Buffer<Hit> hits = guarded<Hit>(count);
    Film film = parts_->film_for(rays);
    film.pixels_once = pixels_once;
    for (int launch = 0; launch < launches; ++launch)
        stages(parts_->traversal, parts_->folder).intersect(parts_->scene, {queue, first, count}, hits, film);
    return {hits.read(device()), read(film)};
}

ShadeResult KernelRig::shade(std::span<const Ray> rays, std::span<const Hit> hits, uint first_slot, uint slot_count,
                             uint first, bool pixels_once) const {
    const Buffer<Ray> queue = filled(rays);
    const Buffer<Hit> hit_queue = filled(hits);
    const std::size_t segments = std::size_t{Stages::chunks(static_cast<uint>(hits.size()))} * slot_count;
    ShadowQueue shadow{guarded<ShadowRay>(segments * CHUNK), guarded<uint>(segments)};
    Film film = parts_->film_for(rays);
    film.pixels_once = pixels_once;
    stages().shade(parts_->scene, {queue, first, static_cast<uint>(hits.size())}, hit_queue, {first_slot, slot_count},
                   shadow, film);
    return {shadow.rays.read(device()), shadow.counts.read(device()), read(film)};
}

FilmState KernelRig::features(std::span<const Ray> rays, std::span<const Hit> hits, uint depth, uint first) const {
    const Buffer<Ray> queue = filled(rays);
    const Buffer<Hit> hit_queue = filled(hits);
    Film film = parts_->film_for(rays);
    stages().features(parts_->scene, {queue, first, static_cast<uint>(hits.size())}, depth, hit_queue, film);
    return read(film);
}

FilmState KernelRig::shadow(std::span<const ShadowRay> rays, std::span<const uint> counts, bool pixels_once) const {
    const ShadowQueue queue{filled(rays), filled(counts)};
    Film film = parts_->film_for(rays);
    film.pixels_once = pixels_once;
    stages(parts_->traversal, parts_->folder).shadow(parts_->scene, queue, static_cast<uint>(counts.size()), film);
    return read(film);
}

SecondaryResult KernelRig::secondary(std::span<const Ray> rays, std::span<const Hit> hits, uint capacity,
                                     uint first) const {
    const Buffer<Ray> queue = filled(rays);
    const Buffer<Hit> hit_queue = filled(hits);
    const Buffer<Ray> children = guarded<Ray>(capacity);
    Buffer<Ray> within = children.first(capacity);
    Film film = parts_->film_for(rays);
    stages().secondary(parts_->scene, {queue, first, static_cast<uint>(hits.size())}, hit_queue, {within}, film);
    return {children.read(device()), read(film)};
}

std::vector<float> resolve_on_device(std::span<const std::int64_t> sums, uint spp) {
    const std::vector<cl_long> values(sums.begin(), sums.end());
    const Film film{{device(), std::span<const cl_long>(values)}, {device(), 1}};
    const Buffer<float> pixels = guarded<float>(values.size());
    Buffer<float> within = pixels.first(values.size());
    stages().resolve(film, spp, within);
    return pixels.read(device());
}

std::vector<uint> run_probe(const std::string& file, const char* name, const std::vector<std::vector<uint>>& inputs,
                            uint items, uint selector, std::size_t output_words) {
    cl::Kernel kernel = make_kernel(shared->probe(file), name);
    std::vector<Buffer<uint>> buffers;
    cl_uint index = 0;
    for (const std::vector<uint>& input : inputs) {
        buffers.push_back(filled(std::span<const uint>(input)));
        kernel.setArg(index++, buffers.back().memory());
    }
    const Buffer<uint> output = guarded<uint>(output_words);
    kernel.setArg(index++, items);
    kernel.setArg(index++, selector);
    kernel.setArg(index++, output.memory());
    device().queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items));
    return output.read(device());
}

}  // namespace raymill::test
