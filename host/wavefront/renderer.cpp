#include "wavefront/renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <numeric>
#include <utility>

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

/// What all pipelines and passes of a frame counted, of what is counted without a profile too.
Counters sum(const std::vector<Counters>& parts) {
    Counters sum = {};
    for (const Counters& part : parts) {
        sum.shadow_rays += part.shadow_rays;
        sum.shadow_traced += part.shadow_traced;
        sum.shadow_blocked += part.shadow_blocked;
        sum.saturated += part.saturated;
        sum.not_a_number += part.not_a_number;
    }
    return sum;
}

/// An exception must not leave waves on their way, into what the next frame begins with, nor another pipeline's command
/// queue in use.
class IdleAtTheEnd {
  public:
    IdleAtTheEnd(const std::vector<Pipeline>& pipelines, Stages& stages) : pipelines_(pipelines), stages_(stages) {}
    IdleAtTheEnd(const IdleAtTheEnd&) = delete;
    IdleAtTheEnd& operator=(const IdleAtTheEnd&) = delete;
    ~IdleAtTheEnd() {
        for (const Pipeline& pipeline : pipelines_) clFinish(pipeline.device.queue());
        stages_.launch_on(pipelines_.front().device.queue);
    }

  private:
    const std::vector<Pipeline>& pipelines_;
    Stages& stages_;
};

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
    const std::size_t count = sums_.size(), bytes = count * sizeof(cl_long);
    const auto* sums =
        static_cast<const cl_long*>(device_.queue.enqueueMapBuffer(sums_.memory(), CL_TRUE, CL_MAP_READ, 0, bytes));
    const std::uint64_t hash = hash_of({sums, count});
    device_.queue.enqueueUnmapMemObject(sums_.memory(), const_cast<cl_long*>(sums));
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
      slot_ranges_(make_slot_ranges(static_cast<uint>(device_scene_.light_slots.size()))) {
    timeline_.measure("allocate queues", [&] { allocate(); });
    timeline_.measure("compile kernels", [&] { compile_kernels(options); });
}

void Renderer::allocate() try {
    sums_ = Buffer<cl_long>(device_, film_pixels(scene_) * FILM_CHANNELS * planes_.count());
    for (int i = 0; i < plan_.pipelines; ++i) {
        Device device = device_;
        if (i > 0) device.queue = cl::CommandQueue(device.context, device.device);
        pipelines_.emplace_back(std::move(device), plan_, slot_ranges_.front().count, slot_ranges_.size(), sums_);
    }
    make_ready();
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
    Pipeline& p = pipelines_.front();
    const Batch nothing;
    switch (stage) {
        case profile::Stage::generate:
            return stages_.generate(device_scene_, 0, 0, p.queues[0]);
        case profile::Stage::intersect:
            return stages_.intersect(device_scene_, p.rays(nothing), p.hits, p.film);
        case profile::Stage::shade:
            return stages_.shade(device_scene_, p.rays(nothing), p.hits, {}, p.shadow_queue, p.film);
        case profile::Stage::shadow:
            return stages_.shadow(device_scene_, p.shadow_queue, 0, p.film);
        case profile::Stage::secondary:
            if (max_depth_ == 0) return;
            return stages_.secondary(device_scene_, p.rays(nothing), p.hits, {p.children(nothing)}, p.film);
        default:
            return;  // not of compiled_stages
    }
}

Frame Renderer::render(const Progress& progress, profile::Detail detail) try {
    const std::int64_t began = profile::now();
    start(detail);
    trace_all(progress);
    Frame frame = read_frame();
    if (profiler_) frame.profile = profiler_->finish(pipelines_.front().waves);
    stages_.observe({});
    profiler_.reset();
    frame.seconds = 1e-9 * static_cast<double>(profile::now() - began);
    if (keep_sums_) frame.sums = sums_.read(device_);
    return frame;
} catch (const cl::Error& error) {
    throw DeviceError(error);
}

void Renderer::start(profile::Detail detail) {
    stages_.observe({});
    profiler_.reset();
    if (detail != profile::Detail::none) {
        const Profiler::FrameShape shape{plan_.queue_capacity, pipelines_.front().shadow_queue.rays.size(),
                                         slot_ranges_.size(), max_depth_};
        profiler_.emplace(device_, shape, detail);
        stages_.observe([this](const LaunchSize& size, const cl::Event& e) { profiler_->launched(size, e); });
    }
    make_ready();
    ready_ = false;
    counts_ = {};
    for (Pipeline& pipeline : pipelines_) {
        pipeline.film.counted = profiler_.has_value();
        pipeline.waves.start();
        pipeline.running.reset();
    }
}

/// The pipelines by turns. What is shown or timed goes through one of them, wave by wave.
void Renderer::trace_all(const Progress& progress) {
    const IdleAtTheEnd idle_at_the_end(pipelines_, stages_);
    const std::uint64_t samples = camera_samples(scene_);
    const std::size_t in_use = observer_ || profiler_ ? 1 : pipelines_.size();
    bool going_on = true;
    // The end is where each pipeline in turn had nothing to begin: what it had before is finished.
    for (std::size_t turn = 0, idle = 0; idle < in_use; turn = (turn + 1) % in_use) {
        Pipeline& pipeline = pipelines_[turn];
        finish_wave(pipeline);
        idle = begin_wave(pipeline, going_on ? samples - counts_.camera : 0) ? 0 : idle + 1;
        if (progress && idle == 0)
            going_on = progress(static_cast<double>(counts_.camera) / static_cast<double>(samples)) && going_on;
    }
    for (const Pipeline& pipeline : pipelines_) pipeline.waves.check_drained();
}

/// Launches a pipeline's next wave, if there is one. to_come: camera samples that no pipeline has begun.
bool Renderer::begin_wave(Pipeline& pipeline, std::uint64_t to_come) {
    stages_.launch_on(pipeline.device.queue);
    std::optional<Batch> batch = pipeline.waves.next(to_come);
    if (!batch) {
        if (to_come == 0) return false;
        const uint count = pipeline.waves.camera_batch(to_come);
        stages_.generate(device_scene_, counts_.camera, count, pipeline.queues[0]);
        counts_.camera += count;
        pipeline.waves.push(0, count);
        batch = pipeline.waves.next(to_come - count);
        show("generate", pipeline, *batch);
    }
    trace(pipeline, *batch);
    pipeline.running = batch;
    return true;
}

Frame Renderer::read_frame() {
    Frame frame;
    const std::uint64_t samples = camera_samples(scene_);
    frame.rgba = resolve();
    frame.samples_per_pixel = scene_.settings.spp;
    frame.planes = planes_;
    std::vector<Counters> parts;
    for (const Pipeline& pipeline : pipelines_)
        for (const Counters& part : pipeline.film.counters.read(device_)) parts.push_back(part);
    const Counters counters = sum(parts);
    if (counters.shadow_rays != counters.shadow_traced)
        throw QueueMismatch(
            fmt::format("{} shadow rays were pushed and {} popped", counters.shadow_rays, counters.shadow_traced));
    counts_.shadow = counters.shadow_rays;
    frame.rays = counts_;
    frame.shadow_blocked = counters.shadow_blocked;
    frame.saturated = counters.saturated;
    frame.not_a_number = counters.not_a_number;
    for (const Pipeline& pipeline : pipelines_)
        for (int depth = 0; depth <= max_depth_; ++depth) frame.waves += pipeline.waves.counts(depth).batches;
    frame.finished = samples > 0 ? static_cast<double>(counts_.camera) / static_cast<double>(samples) : 1;
    return frame;
}

/// Memory costs most when it is touched for the first time: that of the film and the picture is, before the frame
/// begins.
void Renderer::make_ready() {
    if (ready_) return;
    sums_.clear(device_);
    for (Pipeline& pipeline : pipelines_) pipeline.film.counters.clear(device_);
    rgba_.assign(film_pixels(scene_) * FILM_CHANNELS, 0.0f);
    device_.queue.finish();
    ready_ = true;
}

std::vector<float> Renderer::resolve() {
    Buffer<float> pixels = Buffer<float>::over(device_, rgba_);
    stages_.resolve(pipelines_.front().film, static_cast<uint>(scene_.settings.spp), pixels);
    pixels.read_back(device_);
    return std::move(rgba_);
}

void Renderer::trace(Pipeline& p, const Batch& batch) {
    const QueueRange<Ray> rays = p.rays(batch);
    const int spp = scene_.settings.spp;
    p.film.pixels_once = pixels_once(batch.depth, spp);
    stages_.intersect(device_scene_, rays, p.hits, p.film);
    show("intersect", p, batch);
    for (std::size_t pass = 0; pass < slot_ranges_.size(); ++pass) {
        const SlotRange& slots = slot_ranges_[pass];
        p.film.pass = profiler_ ? static_cast<uint>(pass) : 0;
        p.film.pixels_once = pixels_once(batch.depth, spp);
        stages_.shade(device_scene_, rays, p.hits, slots, p.shadow_queue, p.film);
        show("shade", p, batch, slots);
        p.film.pixels_once = pixels_once(batch.depth, spp, slots.count);
        stages_.shadow(device_scene_, p.shadow_queue, Stages::chunks(batch.count) * slots.count, p.film);
        show("shadow", p, batch, slots);
    }
    if (planes_.any_feature()) stages_.features(device_scene_, rays, static_cast<uint>(batch.depth), p.hits, p.film);
    if (batch.depth < max_depth_)
        stages_.secondary(device_scene_, rays, p.hits, {p.children(batch), p.waves.waiting(batch.depth + 1)}, p.film);
    p.device.queue.flush();
}

/// Waits for a pipeline's wave, if it has one, and takes its children.
void Renderer::finish_wave(Pipeline& pipeline) {
    if (!pipeline.running) return;
    const Batch batch = *std::exchange(pipeline.running, {});
    const bool goes_deeper = batch.depth < max_depth_;
    if (!goes_deeper && !profiler_) {
        pipeline.device.queue.finish();
        return;
    }
    if (profiler_) profiler_->settle();
    const Film& film = pipeline.film;
    const std::vector<Counters> counters = film.counters.read(pipeline.device, 0, profiler_ ? film.counters.size() : 1);
    if (goes_deeper) {
        const uint first = pipeline.waves.waiting(batch.depth + 1);
        const std::uint64_t children = counters.front().children;
        pipeline.waves.push(batch.depth + 1, children);
        counts_.secondary += children;
        const QueueRange<Ray> pushed{pipeline.children(batch), first, static_cast<uint>(children)};
        show("secondary", pipeline, batch, {}, pushed);
    }
    if (profiler_) profiler_->end_wave(batch, counters);
}

void Renderer::show(const char* stage, const Pipeline& p, const Batch& batch, SlotRange slots,
                    std::optional<QueueRange<Ray>> children) const {
    if (!observer_) return;
    p.device.queue.finish();
    const std::uint64_t first_sample = counts_.camera - std::min<std::uint64_t>(counts_.camera, batch.count);
    observer_(stage, {batch, p.rays(batch), p.hits, slots, p.shadow_queue, children, p.film, first_sample});
}

}  // namespace raymill
