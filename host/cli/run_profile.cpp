#include "cli/run_profile.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/files.hpp"
#include "device/kernel_cache.hpp"
#include "profile/json.hpp"
#include "profile/trace.hpp"

namespace raymill {

namespace {

profile::KernelCache kernel_cache(std::filesystem::file_time_type since) {
    const std::vector<LoadedKernel> kernels = loaded_kernels(since);
    profile::KernelCache cache;
    cache.known = !kernels.empty();
    cache.built = static_cast<std::uint64_t>(std::ranges::count_if(kernels, &LoadedKernel::built));
    cache.from_cache = kernels.size() - cache.built;
    return cache;
}

}  // namespace

profile::RunProfile RunClock::read(const Scene& scene, const Device& device, const RenderOptions& options,
                                   const Renderer& renderer, Frame& frame) {
    const PixelWindow window = crop_window(scene.settings);
    profile::RunProfile run;
    run.scene = scene.file;
    run.device = device.info.name;
    run.compute_units = device.info.compute_units;
    run.width = window.width;
    run.height = window.height;
    run.samples_per_pixel = scene.settings.spp;
    run.queue_capacity = renderer.memory().queue_capacity;
    run.work_group = options.work_group;
    run.primitives = scene.primitive_count();
    run.device_bytes = renderer.memory().total();
    run.film_hash = timeline.measure("hash film", [&] { return renderer.hash_film(); });
    run.spans = timeline.spans();
    run.spans.insert(run.spans.end(), renderer.setup().begin(), renderer.setup().end());
    std::ranges::sort(run.spans, {}, &profile::Span::start);
    run.kernel_cache = kernel_cache(file_time_);
    run.frame = std::move(frame.profile);
    run.start = start_;
    run.seconds = 1e-9 * static_cast<double>(profile::now() - start_);
    return run;
}

void write_statistics(const std::string& file, const profile::RunProfile& run) {
    write_text_atomically(file, [&](std::ostream& out) {
        out << profile::to_json(run).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    });
}

void write_trace(const std::string& file, const profile::RunProfile& run) {
    write_text_atomically(file, [&](std::ostream& out) { profile::write_trace(out, run); });
}

}  // namespace raymill
