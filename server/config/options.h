// Command line, environment and configuration file of latvoxd: three ways to set the same options.
#ifndef LATVOX_SERVER_CONFIG_OPTIONS_H_
#define LATVOX_SERVER_CONFIG_OPTIONS_H_

#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "core/base/simd.h"
#include "server/base/log.h"
#include "server/config/misspelled_variables.h"
#include "server/config/settings.h"
#include "server/listen/server.h"

namespace latvox {

struct ProgramOptions {
  ServerOptions server;
  LogLevel log_level = LogLevel::kInfo;
  LogFormat log_format = LogFormat::kText;
  Simd simd = Simd::kBest;
  absl::Duration grace = absl::Seconds(10);
  bool exit_with_parent = false;
  int parent_pid = 0;         // the parent for exit_with_parent; 0: the process that started this one
  bool check_config = false;  // show the settings instead of serving
  bool man = false;           // print the manual instead
};

struct Configuration {
  ProgramOptions options;
  std::vector<Setting> settings;  // the same options, as text with their sources
  std::vector<MisspelledVariable> misspelled;
  std::string file;  // path of the configuration file; empty: there is none
};

// The command line overrides the environment (LATVOX_LISTEN and so on), which overrides the file. For --help, --version
// or wrong usage, prints to standard output or error, and returns the exit status instead: 0, or 2.
std::variant<Configuration, int> ParseOptions(int argc, const char* const* argv);

// Does the same again, because the file may have changed. Returns INVALID_ARGUMENT instead of an exit status.
absl::StatusOr<Configuration> ReadOptionsAgain(int argc, const char* const* argv);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_OPTIONS_H_
