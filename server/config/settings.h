// What is in force of an application's options, and where it came from.
#ifndef LATVOX_SERVER_CONFIG_SETTINGS_H_
#define LATVOX_SERVER_CONFIG_SETTINGS_H_

#include <string>
#include <vector>

#include "deploy/manual/command_parser.h"

namespace latvox {

// What a changed file, or a signal SIGHUP, does to an option of a running server.
enum class Reload {
  kNo,       // nothing
  kValue,    // the configuration file's new value holds
  kContent,  // the file that it names is read again, as it is whenever that changes
};

struct Setting {
  std::string name;    // long name of the option, without dashes
  std::string value;   // as the configuration file would have it; empty: not set
  std::string source;  // "flag", "environment NAME", "file PATH" or "default"
  Reload reload = Reload::kNo;
};

// Whether the configuration file has a say in it: neither a flag nor a variable of the environment wins over it.
bool FileDecides(const Setting& setting);

// All options but --help, --version and the like, in the order they were added.
//   file   path of the configuration file, or ""
std::vector<Setting> SettingsOf(const std::vector<OptionState>& options, const std::string& file);

// A configuration file that has all of `settings`, with their sources as comments.
std::string ToToml(const std::vector<Setting>& settings);

// Names of those that differ and that only a new start can change. Both from the same options.
std::vector<std::string> ChangedForRestart(const std::vector<Setting>& before, const std::vector<Setting>& after);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_SETTINGS_H_
