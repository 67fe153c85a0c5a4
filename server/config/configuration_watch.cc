#include "server/config/configuration_watch.h"

#include <algorithm>

#include "absl/strings/str_join.h"
#include "server/base/log.h"

namespace latvox {
namespace {

// Returns the reason why the file does not decide the log level; empty: it does.
std::string WhyLogLevelIsFixed(const Configuration& configuration) {
  if (configuration.file.empty()) return "there is no configuration file";
  const auto is_log_level = [](const Setting& setting) { return setting.name == "log-level"; };
  const auto found = std::find_if(configuration.settings.begin(), configuration.settings.end(), is_log_level);
  return FileDecides(*found) ? "" : found->source;
}

}  // namespace

ConfigurationWatch::ConfigurationWatch(int argc, const char* const* argv, const Configuration& started_with)
    : argc_(argc), argv_(argv), started_with_(started_with.settings) {
  watch_.Add({started_with.file}, [this] { Reload(); });
}

bool ConfigurationWatch::Reload() {
  const std::lock_guard lock(mu_);
  const auto configuration = ReadOptionsAgain(argc_, argv_);
  if (!configuration.ok()) {
    Log(LogLevel::kError, "reload_failed", {{"error", configuration.status().message()}});
    return false;
  }
  const LogLevel level = configuration->options.log_level;
  SetLogLevel(level);
  if (const std::string why = WhyLogLevelIsFixed(*configuration); !why.empty()) {
    Log(std::clamp(level, LogLevel::kWarning, LogLevel::kError), "log_level_fixed", {{"by", why}});
  }
  const std::vector<std::string> waiting = ChangedForRestart(started_with_, configuration->settings);
  if (!waiting.empty()) Log(LogLevel::kWarning, "restart_needed", {{"options", absl::StrJoin(waiting, ",")}});
  Log(LogLevel::kInfo, "configuration_read", {{"path", configuration->file}});
  return true;
}

}  // namespace latvox
