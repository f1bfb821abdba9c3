#include "wavefront/renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <numeric>

#include "common/child_process.hpp"
#include "common/hash.hpp"
#include "device/kernel_cache.hpp"
#include "wavefront/records.hpp"

namespace raymill {

namespace {

/// Consecutive ranges of at most SHADOW_SAMPLES light samples; one empty range without lights, for ambient,
/// emission and coverage.
std::vector<SlotRange> make_slot_ranges(uint slots) {
    std::vector<SlotRange> ranges;
    for (uint first = 0; first < slots; first += SHADOW_SAMPLES)
        ranges.push_back({first, std::min<uint>(SHADOW_SAMPLES, slots - first)});
    if (ranges.empty()) ranges.push_back({0, 0});
    return ranges;
}

/// What all passes of a frame counted; children are those of the last wave.
Counters sum(const std::vector<Counters>& passes) {
    Counters sum = passes.front();
    for (const Counters& pass : std::span(passes).subspan(1)) {
        sum.shadow_rays += pass.shadow_rays;
        sum.shadow_traced += pass.shadow_traced;
        sum.shadow_blocked += pass.shadow_blocked;
        sum.saturated += pass.saturated;
        sum.not_a_number += pass.not_a_number;
    }
    return sum;
}

std::uint64_t camera_samples(const Scene& scene) {
    return film_pixels(scene) * static_cast<std::uint64_t>(scene.settings.spp);
}

}  // namespace

std::span<const cl_long> Frame::plane(int plane) const {
    const std::size_t size = sums.size() / planes.count();
    return std::span(sums).subspan(planes.index(plane) * size, size);
}

namespace {

std::uint64_t hash_of(std::span<const cl_long> sums) {
    // A multiplication has to wait for the one before: each channel has a chain of its own.
    std::array<std::uint64_t, FILM_CHANNELS> chains;
    chains.fill(hash_start);
    for (std::size_t i = 0; i < sums.size(); i += FILM_CHANNELS)
        for (std::size_t channel = 0; channel < FILM_CHANNELS; ++channel)
            chains[channel] = hash_add(chains[channel], static_cast<std::uint64_t>(sums[i + channel]));
    return std::accumulate(chains.begin(), chains.end(), std::uint64_t{0}, hash_add);
}

}  // namespace

std::uint64_t Frame::hash() const {
    return hash_of(sums);
}

std::uint64_t Renderer::hash_film() const try {
    const std::size_t count = film_.sums.size(), bytes = count * sizeof(cl_long);
    const auto* sums = static_cast<const cl_long*>(
        device_.queue.enqueueMapBuffer(film_.sums.memory(), CL_TRUE, CL_MAP_READ, 0, bytes));
    const std::uint64_t hash = hash_of({sums, count});
    device_.queue.enqueueUnmapMemObject(film_.sums.memory(), const_cast<cl_long*>(sums));
    device_.queue.finish();
    return hash;
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

Renderer::Renderer(const Device& device, const Scene& scene, const Bvh& bvh, const RenderOptions& options)
    : device_(device),
      scene_(scene),
      planes_(options.planes),
      keep_sums_(options.keep_sums),
      plan_(plan_memory(scene, bvh, planes_, options.memory, device.info)),
      stages_(
          timeline_.measure(std::string(profile::kernels_span),
                            [&] { return Stages(device, options.work_group, options.kernel_dir, options.traversal); })),
      device_scene_(timeline_.measure("upload scene", [&] { return DeviceScene(device, scene, bvh, planes_); })),
      max_depth_(plan_.queues - 1),
      waves_(plan_.queue_capacity, max_depth_),
      slot_ranges_(make_slot_ranges(static_cast<uint>(device_scene_.light_slots.size()))) {
    timeline_.measure("allocate queues", [&] { allocate_queues(); });
    timeline_.measure("compile kernels", [&] { compile_kernels(options); });
}

void Renderer::allocate_queues() try {
    for (int depth = 0; depth <= max_depth_; ++depth) queues_.emplace_back(device_, waves_.queue_size(depth));
    const std::size_t segments = std::size_t{Stages::chunks(plan_.queue_capacity)} * slot_ranges_.front().count;
    hits_ = Buffer<Hit>(device_, plan_.queue_capacity);
    shadow_queue_ = {{device_, segments * CHUNK}, {device_, segments}};
    film_ = {{device_, film_pixels(scene_) * FILM_CHANNELS * planes_.count()}, {device_, slot_ranges_.size()}};
    make_ready();
    device_.queue.finish();
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

/// Each kernel is launched on nothing: PoCL compiles it then, if its cache on disk lacks it, and in one process only
/// one at a time. So if the first was missing, a second process compiles some of the others at the same time.
void Renderer::compile_kernels(const RenderOptions& options) try {
    const auto began = std::filesystem::file_time_type::clock::now();
    const auto is_helped = [](profile::Stage stage) {
        return std::ranges::find(compile_helper_stages, stage) != compile_helper_stages.end();
    };
    std::vector<profile::Stage> stages = options.compile;
    if (stages.empty()) stages.assign(compiled_stages.begin(), compiled_stages.end());
    const auto helped = std::ranges::stable_partition(stages, std::not_fn(is_helped)).begin();
    std::optional<ChildProcess> helper;
    stages_.run_empty_launches(true);
    for (auto stage = stages.begin(); stage != stages.end(); ++stage) {
        if (stage == helped) helper.reset();  // waits
        compile(*stage);
        device_.queue.finish();
        if (stage != stages.begin() || options.compile_helper.empty()) continue;
        if (std::ranges::any_of(loaded_kernels(began), &LoadedKernel::built)) helper.emplace(options.compile_helper);
    }
    stages_.run_empty_launches(false);
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

void Renderer::compile(profile::Stage stage) {
    const QueueRange<Ray> no_rays{queues_[0]};
    switch (stage) {
        case profile::Stage::generate:
            return stages_.generate(device_scene_, 0, 0, queues_[0]);
        case profile::Stage::intersect:
            return stages_.intersect(device_scene_, no_rays, hits_, film_);
        case profile::Stage::shade:
            return stages_.shade(device_scene_, no_rays, hits_, {}, shadow_queue_, film_);
        case profile::Stage::shadow:
            return stages_.shadow(device_scene_, shadow_queue_, 0, film_);
        case profile::Stage::secondary:
            if (max_depth_ > 0) stages_.secondary(device_scene_, no_rays, hits_, {queues_[1]}, film_);
            return;
        default:
            return;  // not of compiled_stages
    }
}

Frame Renderer::render(const Progress& progress, profile::Detail detail) try {
    const std::int64_t began = profile::now();
    start(detail);
    trace_all(progress);
    Frame frame = read_frame();
    if (profiler_) frame.profile = profiler_->finish(waves_);
    stages_.observe({});
    profiler_.reset();
    frame.seconds = 1e-9 * static_cast<double>(profile::now() - began);
    if (keep_sums_) frame.sums = film_.sums.read(device_);
    return frame;
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

void Renderer::start(profile::Detail detail) {
    stages_.observe({});
    profiler_.reset();
    if (detail != profile::Detail::none) {
        const Profiler::FrameShape shape{plan_.queue_capacity, shadow_queue_.rays.size(), slot_ranges_.size(),
                                         max_depth_};
        profiler_.emplace(device_, shape, detail);
        stages_.observe([this](const LaunchSize& size, const cl::Event& e) { profiler_->launched(size, e); });
    }
    make_ready();
    ready_ = false;
    film_.counted = profiler_.has_value();
    counts_ = {};
    waves_.start();
}

void Renderer::trace_all(const Progress& progress) {
    const std::uint64_t samples = camera_samples(scene_);
    bool going_on = true;
    for (;;) {
        const std::uint64_t to_come = going_on ? samples - counts_.camera : 0;
        std::optional<Batch> batch = waves_.next(to_come);
        if (!batch) {
            if (to_come == 0) break;
            const uint count = waves_.camera_batch(to_come);
            stages_.generate(device_scene_, counts_.camera, count, queues_[0]);
            counts_.camera += count;
            waves_.push(0, count);
            batch = waves_.next(to_come - count);
            show("generate", *batch);
        }
        trace(*batch);
        if (progress)
            going_on = progress(static_cast<double>(counts_.camera) / static_cast<double>(samples)) && going_on;
    }
    waves_.check_drained();
}

Frame Renderer::read_frame() {
    Frame frame;
    const std::uint64_t samples = camera_samples(scene_);
    frame.rgba = resolve();
    frame.samples_per_pixel = scene_.settings.spp;
    frame.planes = planes_;
    const Counters counters = sum(film_.counters.read(device_));
    if (counters.shadow_rays != counters.shadow_traced)
        throw QueueMismatch(
            fmt::format("{} shadow rays were pushed and {} popped", counters.shadow_rays, counters.shadow_traced));
    counts_.shadow = counters.shadow_rays;
    frame.rays = counts_;
    frame.shadow_blocked = counters.shadow_blocked;
    frame.saturated = counters.saturated;
    frame.not_a_number = counters.not_a_number;
    for (int depth = 0; depth <= max_depth_; ++depth) frame.waves += waves_.counts(depth).batches;
    frame.finished = samples > 0 ? static_cast<double>(counts_.camera) / static_cast<double>(samples) : 1;
    return frame;
}

/// Memory costs most when it is touched for the first time: that of the film and the picture is, before the frame
/// begins.
void Renderer::make_ready() {
    if (ready_) return;
    film_.sums.clear(device_);
    film_.counters.clear(device_);
    rgba_.assign(film_pixels(scene_) * FILM_CHANNELS, 0.0f);
    ready_ = true;
}

std::vector<float> Renderer::resolve() {
    Buffer<float> pixels = Buffer<float>::over(device_, rgba_);
    stages_.resolve(film_, static_cast<uint>(scene_.settings.spp), pixels);
    pixels.read_back(device_);
    return std::move(rgba_);
}

void Renderer::trace(const Batch& batch) {
    const QueueRange<Ray> rays{queues_[static_cast<std::size_t>(batch.depth)], batch.first, batch.count};
    const int spp = scene_.settings.spp;
    film_.pixels_once = pixels_once(batch.depth, spp);
    stages_.intersect(device_scene_, rays, hits_, film_);
    show("intersect", batch);
    for (std::size_t pass = 0; pass < slot_ranges_.size(); ++pass) {
        const SlotRange& slots = slot_ranges_[pass];
        film_.pass = profiler_ ? static_cast<uint>(pass) : 0;
        film_.pixels_once = pixels_once(batch.depth, spp);
        stages_.shade(device_scene_, rays, hits_, slots, shadow_queue_, film_);
        show("shade", batch, slots);
        film_.pixels_once = pixels_once(batch.depth, spp, slots.count);
        stages_.shadow(device_scene_, shadow_queue_, Stages::chunks(batch.count) * slots.count, film_);
        show("shadow", batch, slots);
    }
    if (planes_.any_feature()) stages_.features(device_scene_, rays, static_cast<uint>(batch.depth), hits_, film_);
    const bool goes_deeper = batch.depth < max_depth_;
    if (goes_deeper) {
        Buffer<Ray>& children = queues_[static_cast<std::size_t>(batch.depth) + 1];
        stages_.secondary(device_scene_, rays, hits_, {children, waves_.waiting(batch.depth + 1)}, film_);
    }
    if (!goes_deeper && !profiler_) {
        device_.queue.finish();
        return;
    }
    if (profiler_) profiler_->settle();
    const std::vector<Counters> counters = film_.counters.read(device_, 0, profiler_ ? film_.counters.size() : 1);
    if (goes_deeper) take_children(batch, counters.front().children);
    if (profiler_) profiler_->end_wave(batch, counters);
}

void Renderer::take_children(const Batch& batch, std::uint64_t children) {
    const uint first = waves_.waiting(batch.depth + 1);
    waves_.push(batch.depth + 1, children);
    counts_.secondary += children;
    const Buffer<Ray>& queue = queues_[static_cast<std::size_t>(batch.depth) + 1];
    show("secondary", batch, {}, QueueRange<Ray>{queue, first, static_cast<uint>(children)});
}

void Renderer::show(const char* stage, const Batch& batch, SlotRange slots,
                    std::optional<QueueRange<Ray>> children) const {
    if (!observer_) return;
    device_.queue.finish();
    const QueueRange<Ray> rays{queues_[static_cast<std::size_t>(batch.depth)], batch.first, batch.count};
    const std::uint64_t first_sample = counts_.camera - std::min<std::uint64_t>(counts_.camera, batch.count);
    observer_(stage, {batch, rays, hits_, slots, shadow_queue_, children, film_, first_sample});
}

}  // namespace raymill
