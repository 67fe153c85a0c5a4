// The configuration file while the server runs.
#ifndef LATVOX_SERVER_CONFIG_CONFIGURATION_WATCH_H_
#define LATVOX_SERVER_CONFIG_CONFIGURATION_WATCH_H_

#include <mutex>
#include <string>
#include <vector>

#include "server/base/file_watch.h"
#include "server/config/options.h"
#include "server/config/settings.h"

namespace latvox {

// Puts into force what can change while the server runs, which is the log level. The rest of a changed file is named in
// the log, and waits for a new start. Thread-safe.
class ConfigurationWatch {
 public:
  // For the program's arguments, which have to outlive it.
  ConfigurationWatch(int argc, const char* const* argv, const Configuration& started_with);

  // From now on, also whenever the file changes. Once.
  void Follow() { watch_.Start(); }

  // Reads the file again. If it is wrong, which is logged, nothing changes. If the log level is not the file's to say,
  // that is logged as well, at a level that is written. Returns whether the file was good.
  bool Reload();

 private:
  const int argc_;
  const char* const* const argv_;
  const std::vector<Setting> started_with_;
  std::mutex mu_;    // one reads at a time
  FileWatch watch_;  // the first to go: it calls the others
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_CONFIGURATION_WATCH_H_
