#include "program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include "image/temporary_folder.hpp"

namespace raymill {

namespace {

void redirect(int stream, const std::string& file, int flags) {
    const int opened = ::open(file.c_str(), flags, 0600);
    if (opened < 0 || ::dup2(opened, stream) < 0) ::_exit(126);
}

/// In the child, its streams connected: never returns.
[[noreturn]] void become_raymill(const std::vector<std::string>& arguments, const Surroundings& surroundings) {
    if (!surroundings.folder.empty() && ::chdir(surroundings.folder.c_str()) != 0) ::_exit(126);
    for (const auto& [name, value] : surroundings.environment) ::setenv(name.c_str(), value.c_str(), 1);
    constexpr unsigned longest_run = 300;  // seconds; SIGALRM then ends what hangs
    ::alarm(longest_run);
    std::vector<char*> argv = {const_cast<char*>(RAYMILL_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    ::execv(RAYMILL_PROGRAM, argv.data());
    ::_exit(127);
}

/// The two ends of a terminal, closed at the end of the scope.
struct Terminal {
    int ours = -1, theirs = -1;
    Terminal() {
        if (::openpty(&ours, &theirs, nullptr, nullptr, nullptr) != 0)
            throw std::system_error(errno, std::generic_category(), "openpty");
    }
    ~Terminal() {
        ::close(ours);
        close_theirs();
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    void close_theirs() {
        if (theirs >= 0) ::close(std::exchange(theirs, -1));
    }
};

/// Everything that the child writes on the terminal until it closes it.
std::string read_terminal(Terminal& terminal, int pid, const Surroundings& surroundings) {
    terminal.close_theirs();
    std::string text;
    char bytes[4096];
    for (;;) {
        const ssize_t count = ::read(terminal.ours, bytes, sizeof bytes);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return text;  // EIO: nobody has it open any more
        text.append(bytes, static_cast<std::size_t>(count));
        surroundings.watch_terminal(pid, text);
    }
}

int wait_for(int pid) {
    int status = 0;
    while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

bool terminals_can_be_opened() {
    int ours = -1, theirs = -1;
    if (::openpty(&ours, &theirs, nullptr, nullptr, nullptr) != 0) return false;
    ::close(ours);
    ::close(theirs);
    return true;
}

Outcome run_raymill(const std::vector<std::string>& arguments, const Surroundings& surroundings) {
    const TemporaryFolder folder;
    const std::string out = folder.file("out"), err = folder.file("err");
    std::optional<Terminal> terminal;
    if (surroundings.watch_terminal) terminal.emplace();
    const int pid = ::fork();
    if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (pid == 0) {
        redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
        const bool elsewhere = !surroundings.standard_output.empty();
        redirect(STDOUT_FILENO, elsewhere ? surroundings.standard_output : out, O_WRONLY | O_CREAT);
        redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT);
        if (terminal && ::dup2(terminal->theirs, STDERR_FILENO) < 0) ::_exit(126);
        if (terminal) ::close(terminal->theirs), ::close(terminal->ours);
        become_raymill(arguments, surroundings);
    }
    Outcome outcome;
    if (terminal) outcome.err = read_terminal(*terminal, pid, surroundings);
    outcome.status = wait_for(pid);
    if (surroundings.standard_output.empty()) outcome.out = read_bytes(out);
    if (!terminal) outcome.err = read_bytes(err);
    return outcome;
}

std::string small_scene(const std::string& render_keys) {
    return "[render]\nsize = [24, 18]\n" + render_keys + R"(
[camera]
eye = [0, 1.5, 4]
look_at = [0, 0.7, 0]
[[material]]
name = "glass"
diffuse = [0.3, 0.2, 0.1]
specular = 0.5
reflection = 0.2
transmission = 0.5
[[light]]
type = "point"
position = [2, 4, 3]
[[object]]
shape = "sphere"
material = "glass"
center = [0, 0.8, 0]
radius = 0.8
[[object]]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
)";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::size_t count_lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

void expect_failure(const Outcome& outcome, int status, const std::string& part_of_message) {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("raymill: ")) << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with("\n")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, part_of_message)) << outcome.err << "\nwithout: " << part_of_message;
    for (const char* leak : {"std::", "terminate", "exception", "basic_", "what()"})
        EXPECT_FALSE(contains(outcome.err, leak)) << outcome.err;
    EXPECT_EQ(outcome.out, "");
}

}  // namespace raymill
