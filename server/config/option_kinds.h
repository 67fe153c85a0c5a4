// The kinds of latvoxd's options, as rows of a table. Each option is a flag, an environment variable and a key of the
// configuration file: --max-jobs, LATVOX_MAX_JOBS, max-jobs.
#ifndef LATVOX_SERVER_CONFIG_OPTION_KINDS_H_
#define LATVOX_SERVER_CONFIG_OPTION_KINDS_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "deploy/manual/command_parser.h"
#include "deploy/manual/option_row.h"

namespace latvox {

// --max-jobs -> LATVOX_MAX_JOBS
std::string EnvironmentName(absl::string_view flag);

OptionRow Text(const std::string& flag, std::string& value, const std::string& help);
OptionRow File(const std::string& flag, std::string& path, const std::string& help);
OptionRow Address(const std::string& flag, std::string& value, const std::string& help);

// Several texts, given one by one or with commas between them.
OptionRow Texts(const std::string& flag, std::vector<std::string>& values, const std::string& help);

// A whole number, 0 or more.
OptionRow Number(const std::string& flag, uint64_t& value, const std::string& help);
OptionRow Number(const std::string& flag, uint32_t& value, const std::string& help);

// A whole number from 0 to `most`.
OptionRow NumberTo(int most, const std::string& flag, int& value, const std::string& help);

// A number of bytes, such as 1073741824 or 1GiB, or 0.
OptionRow Bytes(const std::string& flag, uint64_t& value, const std::string& help);

// The same number, but not 0.
OptionRow AtLeastOne(OptionRow row);

// A number of seconds from `least` to a day.
OptionRow Seconds(const std::string& flag, double least, absl::Duration& value, const std::string& help);

// One of several words. `value` must have the value of one of them.
template <class T>
OptionRow Choice(const std::string& flag, const std::vector<std::pair<std::string, T>>& choices, T& value,
                 const std::string& help) {
  const auto choose = [choices, &value](const std::string& name) {
    for (const auto& [word, choice] : choices) {
      if (word == name) value = choice;
    }
  };
  OptionRow row{.names = flag, .target = choose, .help = help, .environment = EnvironmentName(flag)};
  for (const auto& [word, choice] : choices) {
    row.words.push_back(word);
    if (choice == value) row.standard = word;
  }
  return row;
}

// Off by default.
OptionRow Switch(const std::string& flag, bool& value, const std::string& help);

// Adds --config. The environment overrides the file. A file that is named must exist.
void AddConfigurationFile(CommandParser& parser);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_OPTION_KINDS_H_
