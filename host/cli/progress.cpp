#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

namespace raymill {

namespace {

// A signal handler can reach nothing but a static flag.
volatile std::sig_atomic_t interrupt_flag = 0;

void on_interrupt(int signal) {
    interrupt_flag = 1;
    std::signal(signal, SIG_DFL);
}

constexpr int bar_width = 32;
constexpr auto redraw_interval = std::chrono::milliseconds(100);

}  // namespace

ProgressBar::ProgressBar(bool enabled) : enabled_(enabled && isatty(STDERR_FILENO)) {}

void ProgressBar::show(double share, const std::string& note) {
    const Clock::time_point now = Clock::now();
    if (!enabled_ || now - last_ < redraw_interval) return;
    last_ = now;
    drawn_ = true;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const int filled = static_cast<int>(share * bar_width);
    fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:3.0f}%  {:.1f} s left  {}\033[K", "", filled, "", bar_width - filled,
               100 * share, share > 0 ? elapsed * (1 - share) / share : 0.0, note);
    std::fflush(stderr);
}

void ProgressBar::clear() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
    drawn_ = false;
}

void print_warnings(const std::vector<Diagnostic>& warnings) {
    for (const Diagnostic& warning : warnings) fmt::print(stderr, "warning: {}\n", to_string(warning));
}

InterruptGuard::InterruptGuard() {
    interrupt_flag = 0;
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::interrupted() const {
    return interrupt_flag != 0;
}

}  // namespace raymill
