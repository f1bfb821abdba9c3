// Records how long the host is at each of its tasks.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "profile/profile.hpp"

namespace raymill::profile {

/// The host's steady clock in nanoseconds: the clock of every time in a profile.
std::int64_t now();

class Timeline {
  public:
    /// Does the work and returns what it returns; its time becomes a span, even if it throws.
    template <class Work>
    decltype(auto) measure(std::string name, Work&& work) {
        const Recording recording(*this, std::move(name));
        return std::forward<Work>(work)();
    }

    const std::vector<Span>& spans() const { return spans_; }

  private:
    class Recording {
      public:
        Recording(Timeline& timeline, std::string name) : timeline_(timeline), name_(std::move(name)), start_(now()) {}
        ~Recording() { timeline_.spans_.push_back({std::move(name_), start_, now()}); }
        Recording(const Recording&) = delete;
        Recording& operator=(const Recording&) = delete;

      private:
        Timeline& timeline_;
        std::string name_;
        std::int64_t start_;
    };
    std::vector<Span> spans_;
};

}  // namespace raymill::profile
