// Command line, environment and configuration file of latvoxd: three ways to set the same options.
#ifndef LATVOX_SERVER_OPTIONS_H_
#define LATVOX_SERVER_OPTIONS_H_

#include <variant>

#include "absl/time/time.h"
#include "core/base/simd.h"
#include "server/log.h"
#include "server/server.h"

namespace latvox {

struct ProgramOptions {
  ServerOptions server;
  LogLevel log_level = LogLevel::kInfo;
  Simd simd = Simd::kBest;
  absl::Duration grace = absl::Seconds(10);
  bool exit_with_parent = false;
};

// The command line wins over the environment (LATVOX_LISTEN and so on), and that over the file. On --help, --version or
// wrong usage, says so on standard output or error and returns the exit status instead: 0, or 2.
std::variant<ProgramOptions, int> ParseOptions(int argc, const char* const* argv);

}  // namespace latvox

#endif  // LATVOX_SERVER_OPTIONS_H_
