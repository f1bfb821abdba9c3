#include "profile/table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace raymill::profile {

namespace {

double ratio(double part, double whole) {
    return whole > 0 ? part / whole : 0;
}

double ratio(std::uint64_t part, std::uint64_t whole) {
    return ratio(static_cast<double>(part), static_cast<double>(whole));
}

std::string heading(const RunProfile& run) {
    const std::string groups =
        run.work_group > 0 ? fmt::format("work-groups of {}", run.work_group) : "work-groups as suits each stage";
    return fmt::format(
        "Statistics of {}\n  {} x {} pixels, {} spp, {} primitives, film hash {:016x}\n  {}, {} compute units\n"
        "  waves of at most {} rays, {}, {:.1f} MiB on the device\n",
        run.scene, run.width, run.height, run.samples_per_pixel, run.primitives, run.film_hash, run.device,
        run.compute_units, run.queue_capacity, groups, static_cast<double>(run.device_bytes) / (1 << 20));
}

std::string time_line(std::string_view name, double seconds, double whole, const std::string& note = {}) {
    return fmt::format("  {:<28}{:>10.4f}{:>8.1f} %{}\n", name, seconds, 100 * ratio(seconds, whole), note);
}

std::string kernel_note(const KernelCache& cache) {
    if (!cache.known) return "   (whether from the runtime's cache, it does not tell)";
    return fmt::format("   ({} compiled in this run, {} from the cache)", cache.built, cache.from_cache);
}

std::string times(const RunProfile& run) {
    std::string text = fmt::format("\n{:<30}{:>10}{:>10}\n", "Time", "seconds", "share");
    for (const Span& span : run.spans) {
        text += time_line(span.name, span.seconds(), run.seconds,
                          span.name == kernels_span ? kernel_note(run.kernel_cache) : "");
        if (span.name != render_span) continue;
        text += time_line("  kernels", run.frame.times.kernels, run.seconds);
        text += time_line("  first launches", run.frame.times.first_launches, run.seconds);
        text += time_line("  launching, device idle", run.frame.times.launching, run.seconds);
        text += time_line("  host, device idle", run.frame.times.host, run.seconds);
    }
    text += time_line("not measured", run.unaccounted(), run.seconds);
    return text + time_line("wall clock", run.seconds, run.seconds);
}

std::string stages(const FrameProfile& frame) {
    std::string text = fmt::format("\n{:<12}{:>9}{:>14}{:>14}{:>7}{:>10}{:>8}{:>9}{:>11}{:>11}{:>12}\n", "Stage",
                                   "launches", "items in", "items out", "full", "seconds", "share", "ns/item",
                                   "B read/it.", "B writ./it.", "atomics/it.");
    for (std::size_t i = 0; i < stage_count; ++i) {
        const StageTotal total = frame.total(static_cast<Stage>(i));
        if (total.launches == 0) continue;
        // What a stage does per item: generate has no items but those that it makes.
        const std::uint64_t items = std::max<std::uint64_t>(total.items_in, 1);
        text +=
            fmt::format("  {:<10}{:>9}{:>14}{:>14}{:>5.0f} %{:>10.4f}{:>6.1f} %{:>9.1f}{:>11.1f}{:>11.1f}{:>12.2f}\n",
                        stage_name(total.stage), total.launches, total.items_in, total.items_out,
                        100 * total.fullness(), total.seconds, 100 * ratio(total.seconds, frame.times.seconds),
                        1e9 * total.seconds / static_cast<double>(items), ratio(total.traffic.bytes_read, items),
                        ratio(total.traffic.bytes_written, items), ratio(total.traffic.atomics, items));
    }
    return text;
}

std::string depth_line(std::string_view name, const DepthTotal& d) {
    const double rays = static_cast<double>(std::max<std::uint64_t>(d.fates.rays(), 1));
    const auto share = [&](std::uint64_t count) { return 100 * static_cast<double>(count) / rays; };
    return fmt::format("  {:<6}{:>8}{:>14}{:>9.1f} %{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.2f}{:>14}{:>9.1f} %\n", name,
                       d.waves, d.popped, 100 * ratio(d.high_water, d.capacity), share(d.fates.missed),
                       share(d.fates.absorbed), share(d.fates.depth_limit), share(d.fates.weightless),
                       ratio(d.fates.children(), d.fates.hits()), d.shadow_rays,
                       100 * ratio(d.shadow_blocked, d.shadow_rays));
}

std::string depths(const FrameProfile& frame) {
    std::string text =
        fmt::format("\n{:<8}{:>8}{:>14}{:>11}{:>9}{:>9}{:>9}{:>9}{:>9}{:>14}{:>11}\n", "Depth", "waves", "rays",
                    "queue full", "missed%", "absorb.%", "limit%", "weight%", "kids/hit", "shadow rays", "blocked");
    DepthTotal sum;
    std::size_t reached = 0;
    for (const DepthTotal& depth : frame.depths) {
        if (depth.waves == 0) break;  // what is deeper has none either
        ++reached;
        text += depth_line(std::to_string(depth.depth), depth);
        sum.waves += depth.waves;
        sum.popped += depth.popped;
        sum.capacity = std::max(sum.capacity, depth.capacity);
        sum.high_water = std::max(sum.high_water, depth.high_water);
        sum.shadow_rays += depth.shadow_rays;
        sum.shadow_blocked += depth.shadow_blocked;
    }
    if (reached < frame.depths.size()) text += fmt::format("  {} and deeper: no rays\n", frame.depths[reached].depth);
    sum.fates = frame.fates();
    if (frame.depths.size() > 1) text += depth_line("all", sum);
    const double rays = static_cast<double>(sum.popped + sum.shadow_rays);
    return text + fmt::format("  {} rays, {:.2f} Mrays/s\n", sum.popped + sum.shadow_rays,
                              ratio(1e-6 * rays, frame.times.seconds));
}

}  // namespace

std::string table(const RunProfile& run) {
    return heading(run) + times(run) + stages(run.frame) + depths(run.frame);
}

}  // namespace raymill::profile
