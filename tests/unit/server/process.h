// latvoxd as a process, for tests.
#ifndef LATVOX_TESTS_UNIT_SERVER_PROCESS_H_
#define LATVOX_TESTS_UNIT_SERVER_PROCESS_H_

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

namespace latvox {

// Starts a program whose standard error can be read.
class Process {
 public:
  explicit Process(std::vector<std::string> command) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    std::vector<char*> arguments;
    arguments.reserve(command.size() + 1);
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }
  ~Process() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      Wait();
    }
    close(output_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }

  // Output so far, after `text` has come, or all.
  std::string ReadUntil(const std::string& text) {
    char byte = 0;
    while (all_.find(text) == std::string::npos && read(output_, &byte, 1) == 1) all_ += byte;
    return all_;
  }
  std::string ReadLineWith(const std::string& text) {
    ReadUntil(text);
    char byte = 0;
    while (all_.back() != '\n' && read(output_, &byte, 1) == 1) all_ += byte;
    const size_t at = all_.find(text);
    return at == std::string::npos ? "" : all_.substr(at + text.size(), all_.find('\n', at) - at - text.size());
  }
  std::string ReadAll() { return ReadUntil("\n\n\n"); }

  // Exit status, or minus the signal.
  int Wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
  int output_ = -1;
  std::string all_;
};

inline std::vector<std::string> Latvoxd(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), LATVOXD);
  return arguments;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_PROCESS_H_
