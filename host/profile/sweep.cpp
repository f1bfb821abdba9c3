#include "profile/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace raymill::profile {

namespace {

bool same_series(const SweepSetting& a, const SweepSetting& b) {
    return a.work_group == b.work_group && a.threads == b.threads;
}

/// Measured settings that differ from the best in their capacity alone, from the smallest on.
std::vector<std::size_t> series_of(const Sweep& sweep, std::size_t best) {
    std::vector<std::size_t> series;
    for (std::size_t i = 0; i < sweep.settings.size(); ++i)
        if (sweep.settings[i].measured() && same_series(sweep.settings[i], sweep.settings[best])) series.push_back(i);
    std::ranges::sort(series, {}, [&](std::size_t i) { return sweep.settings[i].queue_capacity; });
    return series;
}

void find_best(const Sweep& sweep, Finding& finding) {
    for (std::size_t i = 0; i < sweep.settings.size(); ++i)
        if (sweep.settings[i].measured() &&
            (!finding.best || rays_per_second(sweep.settings[i]) > rays_per_second(sweep.settings[*finding.best])))
            finding.best = i;
    if (!finding.best) return;
    const double median = spread(sweep.settings[*finding.best]).median;
    for (std::size_t i = 0; i < sweep.settings.size(); ++i)
        if (i != *finding.best && sweep.settings[i].measured() && spread(sweep.settings[i]).shortest <= median)
            finding.as_good.push_back(i);
}

void find_knee(const Sweep& sweep, Finding& finding) {
    if (!finding.best) return;
    const double best = rays_per_second(sweep.settings[*finding.best]);
    const auto loss = [&](std::size_t i) { return 1 - rays_per_second(sweep.settings[i]) / best; };
    const auto on_plateau = [&](std::size_t i) {
        return loss(i) <= knee_tolerance || std::ranges::find(finding.as_good, i) != finding.as_good.end();
    };
    const std::vector<std::size_t> series = series_of(sweep, *finding.best);
    const auto knee = std::ranges::find_if(series, on_plateau);
    finding.knee = *knee;  // the best itself is one of them
    if (knee == series.begin()) return;
    finding.below_knee = *(knee - 1);
    finding.loss_below_knee = 1;
    for (auto i = series.begin(); i != knee; ++i) finding.loss_below_knee = std::min(finding.loss_below_knee, loss(*i));
}

void compare_images(const Sweep& sweep, Finding& finding) {
    for (std::size_t i = 0; i < sweep.settings.size(); ++i) {
        const SweepSetting& setting = sweep.settings[i];
        if (!finding.film_hash && setting.measured()) finding.film_hash = setting.frames.front().film_hash;
        const auto differs = [&](std::uint64_t hash) { return hash != *finding.film_hash; };
        const bool other_profiled = setting.profile && finding.film_hash && differs(setting.profile->film_hash);
        if (other_profiled || std::ranges::any_of(setting.frames, differs, &TimedFrame::film_hash))
            finding.other_image.push_back(i);
    }
}

std::string knee_words(const Sweep& sweep, const Finding& finding) {
    const std::uint64_t capacity = sweep.settings[*finding.knee].queue_capacity;
    if (series_of(sweep, *finding.best).size() < 2) return "";
    if (finding.knee == finding.best && !finding.below_knee) return "; no knee: the smallest queue is the best";
    if (!finding.below_knee) return fmt::format("; no knee: queues of {} rays are about as good", capacity);
    const bool only_one = *finding.below_knee == series_of(sweep, *finding.best).front();
    return fmt::format("; the knee is at {}: smaller queues lose {:.0f} %{}", capacity, 100 * finding.loss_below_knee,
                       only_one ? "" : " or more");
}

}  // namespace

Spread spread(const SweepSetting& setting) {
    if (setting.frames.empty()) return {};
    std::vector<double> seconds;
    for (const TimedFrame& frame : setting.frames) seconds.push_back(frame.seconds);
    std::ranges::sort(seconds);
    const std::size_t half = seconds.size() / 2;
    const double median = seconds.size() % 2 == 1 ? seconds[half] : (seconds[half - 1] + seconds[half]) / 2;
    return {median, seconds.front(), seconds.back()};
}

double rays_per_second(const SweepSetting& setting) {
    const double seconds = spread(setting).median;
    return seconds > 0 ? static_cast<double>(setting.rays) / seconds : 0;
}

Finding find(const Sweep& sweep) {
    Finding finding;
    find_best(sweep, finding);
    find_knee(sweep, finding);
    compare_images(sweep, finding);
    return finding;
}

std::string work_group_name(std::uint64_t work_group) {
    return work_group == 0 ? "auto" : std::to_string(work_group);
}

std::string headline(const Sweep& sweep, const Finding& finding) {
    std::string words = sweep.complete ? "" : "Interrupted, so this is a part of the sweep. ";
    if (!finding.same_image())
        words +=
            fmt::format("The image is NOT the same: {} of the settings gave another one. ", finding.other_image.size());
    if (!finding.best) return words + "Nothing was measured.";
    const SweepSetting& best = sweep.settings[*finding.best];
    std::set<unsigned> threads;
    for (const SweepSetting& setting : sweep.settings) threads.insert(setting.threads);
    words += fmt::format(
        "Best: {} rays, work-group {}{}: {:.2f} Mrays/s", best.queue_capacity, work_group_name(best.work_group),
        threads.size() > 1 ? fmt::format(", {} threads", best.threads) : "", 1e-6 * rays_per_second(best));
    words += knee_words(sweep, finding);
    const bool compared = std::ranges::count_if(sweep.settings, &SweepSetting::measured) > 1;
    if (compared && best.frames.size() == 1) words += ". One frame of each does not tell speed from chance";
    return words;
}

}  // namespace raymill::profile
