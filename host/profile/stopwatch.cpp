#include "profile/stopwatch.hpp"

#include <chrono>
#include <ctime>
#include <thread>

namespace raymill::profile {

namespace {

/// Workers of the one side that still look for work would take a core from the other.
constexpr std::chrono::milliseconds pause_between{2};

double seconds_now(Clock clock) {
    timespec now{};
    clock_gettime(clock == Clock::wall ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double seconds_of(const std::function<void()>& work, Clock clock) {
    std::this_thread::sleep_for(pause_between);
    const double start = seconds_now(clock);
    work();
    return seconds_now(clock) - start;
}

}  // namespace raymill::profile
