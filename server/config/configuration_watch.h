// Watches the configuration file while the server runs.
#ifndef LATVOX_SERVER_CONFIG_CONFIGURATION_WATCH_H_
#define LATVOX_SERVER_CONFIG_CONFIGURATION_WATCH_H_

#include <mutex>
#include <string>
#include <vector>

#include "server/base/file_watch.h"
#include "server/config/options.h"
#include "server/config/settings.h"

namespace latvox {

// Applies changes that are possible in a running server: the log level. Logs the names of other changed options, which
// wait for a restart. Thread-safe.
class ConfigurationWatch {
 public:
  // For the program's arguments, which must outlive it.
  ConfigurationWatch(int argc, const char* const* argv, const Configuration& started_with);

  // Watches the file from now on. Call it once.
  void Follow() { watch_.Start(); }

  // Reads the file again. If the file is wrong, logs that, and changes nothing. If a flag or variable decides the log
  // level, logs that as well, at a visible level. Returns whether the file was valid.
  bool Reload();

 private:
  const int argc_;
  const char* const* const argv_;
  const std::vector<Setting> started_with_;
  std::mutex mu_;    // one thread reads at a time
  FileWatch watch_;  // destroyed first, because it calls the others
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_CONFIGURATION_WATCH_H_
