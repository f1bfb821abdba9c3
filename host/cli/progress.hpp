// What a person sees while waiting, on standard error.
#pragma once

#include <chrono>
#include <string>

#include "scene/error.hpp"

namespace raymill {

/// A bar that is redrawn in place; silent unless standard error is a terminal.
class ProgressBar {
  public:
    explicit ProgressBar(bool enabled);
    ~ProgressBar() { clear(); }
    /// share in [0, 1]; note: what is going on. Redraws at most ten times a second.
    void show(double share, const std::string& note = {});
    /// Wipes the bar, so that the next line starts clean.
    void clear();

  private:
    using Clock = std::chrono::steady_clock;
    bool enabled_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

/// "warning: file:line:column: message" for each, on standard error.
void print_warnings(const std::vector<Diagnostic>& warnings);

/// While it lives, Ctrl-C and SIGTERM only set a flag; a second Ctrl-C ends the program as usual.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    bool interrupted() const;
};

}  // namespace raymill
