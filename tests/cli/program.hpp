// The program run as a user runs it: arguments in, status and both streams out.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace raymill {

struct Outcome {
    int status = -1;  // exit status, or 128 + the signal that ended it, as shells say
    std::string out;
    std::string err;
};

struct Surroundings {
    std::string folder{};                              // to run in; empty: this one
    std::string standard_output{};                     // a file that receives it in place of Outcome::out
    std::map<std::string, std::string> environment{};  // added to this one's
    // Standard error is a terminal, and this is called with all that has appeared there whenever there is more.
    std::function<void(int pid, const std::string& terminal)> watch_terminal{};
};

/// Whether Surroundings::watch_terminal works here: bare roots and some containers have no /dev/pts.
bool terminals_can_be_opened();

/// Runs `raymill` with these arguments and waits for its end.
Outcome run_raymill(const std::vector<std::string>& arguments, const Surroundings& surroundings = {});

/// A scene of a lit sphere above a plane, 24 x 18 pixels, with `render_keys` in its [render] table from line 3 on.
std::string small_scene(const std::string& render_keys = "");

/// "contains(text, part)" with both in the message.
bool contains(const std::string& text, const std::string& part);

std::size_t count_lines(const std::string& text);

/// The message of a failed run: one sentence that starts with the program's name, and names no exception.
void expect_failure(const Outcome& outcome, int status, const std::string& part_of_message);

}  // namespace raymill
