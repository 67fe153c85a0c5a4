// The server's log, for tests of its lines.
#ifndef LATVOX_TESTS_UNIT_SERVER_LOG_LINES_H_
#define LATVOX_TESTS_UNIT_SERVER_LOG_LINES_H_

#include <gtest/gtest.h>

#include <string>

#include "server/base/log.h"

namespace latvox {

// Logs from its construction to End, in place of standard error. One at a time.
class LogLines {
 public:
  explicit LogLines(LogLevel level = LogLevel::kInfo) {
    testing::internal::CaptureStderr();
    StartLog(level, LogFormat::kText);
  }
  std::string End() {
    StopLog();
    return testing::internal::GetCapturedStderr();
  }
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_LOG_LINES_H_
