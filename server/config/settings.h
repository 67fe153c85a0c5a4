// The options in force, and their sources.
#ifndef LATVOX_SERVER_CONFIG_SETTINGS_H_
#define LATVOX_SERVER_CONFIG_SETTINGS_H_

#include <string>
#include <vector>

#include "deploy/manual/command_parser.h"

namespace latvox {

// The effect of a changed file, or of SIGHUP, on an option of a running server.
enum class Reload {
  kNo,       // no effect
  kValue,    // the new value of the configuration file holds
  kContent,  // the named file is read again, as after every change
};

struct Setting {
  std::string name;    // long name of the option, without dashes
  std::string value;   // in the form of the configuration file; empty: not set
  std::string source;  // "flag", "environment NAME", "file PATH" or "default"
  Reload reload = Reload::kNo;
};

// Whether the configuration file decides the option: no flag and no environment variable overrides it.
bool FileDecides(const Setting& setting);

// Returns all options except --help, --version and the like, in the order of their addition.
//   file   path of the configuration file, or ""
std::vector<Setting> SettingsOf(const std::vector<OptionState>& options, const std::string& file);

// Returns a configuration file with all of `settings`, and their sources as comments.
std::string ToToml(const std::vector<Setting>& settings);

// Returns the names of options that differ and that only a restart changes. Both arguments come from the same options.
std::vector<std::string> ChangedForRestart(const std::vector<Setting>& before, const std::vector<Setting>& after);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_SETTINGS_H_
