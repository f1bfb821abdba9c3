// What people and spreadsheets read of a sweep.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <ostream>

#include "profile/sweep_output.hpp"

namespace raymill::profile {

namespace {

constexpr double mebibyte = 1 << 20;

void write_row(std::ostream& out, std::size_t run, const SweepSetting& setting, const StageTotal& total) {
    const Spread seconds = spread(setting);
    fmt::print(out, "{},{},{},{},{},{},{},{},{},{},{},{},", run, setting.queue_capacity,
               work_group_name(setting.work_group), setting.threads, setting.device_bytes, setting.frames.size(),
               seconds.median, seconds.shortest, seconds.longest, setting.rays,
               total.depth == no_depth ? "" : std::to_string(total.depth), stage_name(total.stage));
    fmt::print(out, "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", total.launches, total.items_in, total.items_out,
               total.capacity, total.high_water, total.work_items, total.groups, total.places, total.fullness(),
               total.seconds, total.shortest, total.longest, total.traffic.bytes_read, total.traffic.bytes_written,
               total.traffic.atomics);
}

std::string setting_line(const Sweep& sweep, std::size_t i, const Finding& finding) {
    const SweepSetting& setting = sweep.settings[i];
    const std::string line =
        fmt::format("{:>10}{:>12}{:>9}", setting.queue_capacity, work_group_name(setting.work_group), setting.threads);
    if (!setting.skipped.empty()) return fmt::format("{}   skipped: {}\n", line, setting.skipped);
    if (!setting.measured()) return fmt::format("{}   not reached\n", line);
    const Spread seconds = spread(setting);
    return fmt::format("{}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.2f}{:>12.1f}{}{}\n", line, seconds.median, seconds.shortest,
                       seconds.longest, 1e-6 * rays_per_second(setting),
                       static_cast<double>(setting.device_bytes) / mebibyte, i == finding.best ? "  best" : "",
                       i == finding.knee && finding.below_knee ? "  knee" : "");
}

}  // namespace

void write_csv(std::ostream& out, const Sweep& sweep) {
    out << "run,queue_capacity,work_group,threads,device_bytes,frames,frame_median,frame_shortest,frame_longest,rays,"
           "depth,stage,launches,items_in,items_out,capacity,high_water,work_items,groups,places,fullness,seconds,"
           "shortest,longest,bytes_read,bytes_written,atomics\n";
    for (std::size_t run = 0; run < sweep.settings.size(); ++run)
        if (sweep.settings[run].profile)
            for (const StageTotal& total : sweep.settings[run].profile->frame.stages)
                write_row(out, run, sweep.settings[run], total);
}

std::string table(const Sweep& sweep) {
    const Finding finding = find(sweep);
    std::string text = fmt::format("{:>10}{:>12}{:>9}{:>10}{:>10}{:>10}{:>10}{:>12}\n", "rays", "work-group", "threads",
                                   "median s", "shortest", "longest", "Mrays/s", "device MiB");
    for (std::size_t i = 0; i < sweep.settings.size(); ++i) text += setting_line(sweep, i, finding);
    return text + headline(sweep, finding) + "\n";
}

}  // namespace raymill::profile
