// The lines of the log on standard error: in order, soon, and without a wait for a reader.
#include "server/base/log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <string>

namespace latvox {
namespace {

// Standard error as a pipe, from its construction to its destruction.
class PipedLog {
 public:
  PipedLog() {
    EXPECT_EQ(pipe2(ends_, O_CLOEXEC), 0);
    dup2(ends_[1], STDERR_FILENO);
    StartLog(LogLevel::kInfo, LogFormat::kText);
  }
  ~PipedLog() {
    StopLog();
    dup2(before_, STDERR_FILENO);
    for (const int fd : {before_, ends_[0], ends_[1]}) close(fd);
  }

  // Reads until `end` has come, and returns all.
  std::string ReadUpTo(const std::string& end) const {
    std::string text;
    char piece[4096];
    while (text.find(end) == std::string::npos) {
      const ssize_t count = read(ends_[0], piece, sizeof piece);
      if (count <= 0) break;
      text.append(piece, static_cast<size_t>(count));
    }
    return text;
  }

  // Waits until no line more can be written.
  void AwaitFullPipe() const {
    pollfd writable{ends_[1], POLLOUT, 0};
    while (poll(&writable, 1, 0) > 0) usleep(1000);
  }

 private:
  const int before_ = dup(STDERR_FILENO);
  int ends_[2];
};

TEST(Log, WritesLinesInOrderWithoutAFurtherCall) {
  const PipedLog log;
  for (int n = 0; n < 3; ++n) Log(LogLevel::kInfo, "event", {{"n", n}});
  const std::string text = log.ReadUpTo("n=2\n");
  const size_t first = text.find("event=event n=0\n"), second = text.find("event=event n=1\n");
  EXPECT_LT(first, second);
  EXPECT_LT(second, text.find("event=event n=2\n"));
  Log(LogLevel::kInfo, "later", {});
  EXPECT_NE(log.ReadUpTo("later\n").find("level=info event=later\n"), std::string::npos);
}

TEST(Log, LosesTheOldestLinesWhileNobodyReads) {
  const PipedLog log;
  int n = 0;
  for (; n < 3000; ++n) Log(LogLevel::kInfo, "event", {{"n", n}});
  log.AwaitFullPipe();
  for (; n < 23000; ++n) Log(LogLevel::kInfo, "event", {{"n", n}});
  const std::string text = log.ReadUpTo("n=22999\n");
  EXPECT_NE(text.find("n=0\n"), std::string::npos);
  EXPECT_EQ(text.find("n=10000\n"), std::string::npos);
  EXPECT_NE(text.find("n=22000\n"), std::string::npos);
}

}  // namespace
}  // namespace latvox
