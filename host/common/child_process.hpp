// A program that runs beside this one.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace raymill {

/// Runs a command without input or output; its environment is this process's. For work that can be left out: whether it
/// started, and how it ended, is not told. The destructor waits for its end.
class ChildProcess {
  public:
    /// command: the program's file, and its arguments.
    explicit ChildProcess(const std::vector<std::string>& command);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

  private:
    pid_t process_ = -1;
};

/// The file of this program, to run it again; empty where the system does not tell.
std::string this_program();

}  // namespace raymill
