// Renders a scene with one setting after another and notes what each took.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/progress.hpp"
#include "cli/run_profile.hpp"
#include "profile/sweep.hpp"

namespace raymill {

/// What a sweep goes through: every combination of the three lists.
struct SweepLists {
    std::vector<std::uint32_t> queue_capacities;
    std::vector<std::uint32_t> work_groups;  // 0: what suits each stage
    std::vector<std::uint32_t> threads;      // 0: all
    int repeats = 5;
};

/// Interleaved: a round goes through all settings, the next one back, so that a machine that slows down, or a neighbour
/// that comes and goes, does not fall on one setting. A setting that does not fit the device is skipped with the
/// reason.
class Sweeper {
  public:
    /// Opens the devices. `scene`'s samples per pixel may still change before run(). The references must outlive it.
    /// Throws DeviceError if none of the numbers of threads can be had.
    Sweeper(const DeviceArguments& arguments, const SweepLists& lists, const Scene& scene, const Bvh& bvh,
            const InterruptGuard& guard, ProgressBar& bar);

    /// With the most threads.
    const Device& device() const { return devices_.rbegin()->second; }

    /// Seconds of a frame at the default capacity; nothing if an interrupt comes.
    std::optional<double> time_frame() const;

    /// Renders everything and adds it to `sweep`, which is complete unless an interrupt comes in between. Throws
    /// DeviceError if no setting fits.
    void run(profile::Sweep& sweep);

  private:
    void add_settings(profile::Sweep& sweep) const;
    bool rounds(profile::Sweep& sweep);
    void visit(profile::Sweep& sweep, std::size_t index);
    void measure(profile::Sweep& sweep, std::size_t index);
    /// Nothing if an interrupt came before its end.
    std::optional<profile::RunProfile> profiled_frame(RunClock& clock, const Device& device,
                                                      const RenderOptions& options, Renderer& renderer,
                                                      const profile::SweepSetting& setting);
    static void keep_profile(profile::Sweep& sweep, std::size_t index, profile::RunProfile run);
    bool record_timeline(profile::Sweep& sweep);
    RenderOptions options_of(const profile::SweepSetting& setting) const;
    Progress progress(const profile::SweepSetting& setting);

    const DeviceArguments& arguments_;
    SweepLists lists_;
    const Scene& scene_;
    const Bvh& bvh_;
    const InterruptGuard& guard_;
    ProgressBar& bar_;
    std::map<unsigned, Device> devices_;       // by number of threads
    std::map<unsigned, std::string> refused_;  // numbers of threads that cannot be had, and why
    std::size_t visits_ = 0, visits_done_ = 0;
};

}  // namespace raymill
