// What a piece of work takes.
#pragma once

#include <functional>

namespace raymill::profile {

/// wall: what a user waits. processor: of all the program's threads, which other programs on the machine disturb less;
/// with more than one thread it also counts those that wait in a loop.
enum class Clock { wall, processor };

/// Seconds that `work` takes, after a pause in which the threads of what ran before fall asleep.
double seconds_of(const std::function<void()>& work, Clock clock);

}  // namespace raymill::profile
