// The part of TBB that Raymill uses, over plain threads: for the preset tsan alone. Debian's TBB is not built with
// ThreadSanitizer, which then does not see that a task starts after what comes before it, and reports all that tasks
// touch.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>

namespace tbb {

inline constexpr int plain_thread_limit = 4;
inline std::atomic<int> plain_threads = 0;

/// Runs both, the first in a thread of its own unless there are enough.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
    if (plain_threads.fetch_add(1, std::memory_order_relaxed) < plain_thread_limit) {
        std::thread other(first);
        second();
        other.join();
    } else {
        first();
        second();
    }
    plain_threads.fetch_sub(1, std::memory_order_relaxed);
}

/// body(i) for all i from begin to end - 1, those of odd and of even place in different threads.
template <class Body>
void parallel_for(std::size_t begin, std::size_t end, const Body& body) {
    const auto every_second = [&](std::size_t first) {
        for (std::size_t i = first; i < end; i += 2) body(i);
    };
    parallel_invoke([&] { every_second(begin); }, [&] { every_second(begin + 1); });
}

template <class Value>
class blocked_range {
  public:
    blocked_range(Value begin, Value end, std::size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}
    Value begin() const { return begin_; }
    Value end() const { return end_; }
    std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
    std::size_t grainsize() const { return grain_; }

  private:
    Value begin_, end_;
    std::size_t grain_;
};

/// Halves the range down to its grain; each half begins with `identity`.
template <class Range, class Result, class Body, class Join>
Result parallel_reduce(const Range& range, const Result& identity, const Body& body, const Join& join) {
    if (range.size() <= range.grainsize()) return body(range, identity);
    const auto middle = range.begin() + range.size() / 2;
    Result left = identity, right = identity;
    parallel_invoke(
        [&] { left = parallel_reduce(Range(range.begin(), middle, range.grainsize()), identity, body, join); },
        [&] { right = parallel_reduce(Range(middle, range.end(), range.grainsize()), identity, body, join); });
    return join(left, right);
}

class task_arena {
  public:
    static constexpr int automatic = -1;
    explicit task_arena(int) {}
    template <class Work>
    auto execute(const Work& work) {
        return work();
    }
};

}  // namespace tbb
