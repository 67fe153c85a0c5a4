// The kinds of options that latvoxd has. Each is a flag, an environment variable and a key of the configuration file:
// --max-jobs, LATVOX_MAX_JOBS, max-jobs.
#ifndef LATVOX_SERVER_CONFIG_OPTION_KINDS_H_
#define LATVOX_SERVER_CONFIG_OPTION_KINDS_H_

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace latvox {

// --max-jobs -> LATVOX_MAX_JOBS
std::string EnvironmentName(absl::string_view flag);

const CLI::Validator& AtLeastOne();

// What CLI11 would take otherwise: -1 for 2^64 - 1, and 010 for 8.
const CLI::Validator& WithoutSign();

template <class T>
CLI::Option* Add(CLI::App& app, const std::string& flag, T& value, const std::string& description) {
  CLI::Option* option = app.add_option(flag, value, description)->envname(EnvironmentName(flag));
  if constexpr (std::is_integral_v<T>) option->check(WithoutSign());
  return option->capture_default_str();
}

// Makes the option's value a number of bytes, as 1073741824 or 1GiB, or 0.
CLI::Option* TakeBytes(CLI::Option* option);

// The same of at least 1.
CLI::Option* AddBytes(CLI::App& app, const std::string& flag, uint64_t& value, const std::string& description);

// A number of seconds from `least` to a day.
CLI::Option* AddSeconds(CLI::App& app, const std::string& flag, double least, absl::Duration& value,
                        const std::string& description);

// One of some words. `value` must be that of one of them.
template <class T>
CLI::Option* AddChoice(CLI::App& app, const std::string& flag, const std::vector<std::pair<std::string, T>>& choices,
                       T& value, const std::string& description) {
  std::vector<std::string> words;
  std::string chosen;
  for (const auto& [word, choice] : choices) {
    words.push_back(word);
    if (choice == value) chosen = word;
  }
  const auto set = [choices, &value](const std::string& name) {
    for (const auto& [word, choice] : choices) {
      if (word == name) value = choice;
    }
  };
  return app.add_option_function<std::string>(flag, set, description)
      ->envname(EnvironmentName(flag))
      ->default_str(chosen)
      ->check(CLI::IsMember(words));
}

// Off unless given.
CLI::Option* AddSwitch(CLI::App& app, const std::string& flag, bool& value, const std::string& description);

// Adds --config; the file stands below the environment, and must exist if it is named.
void AddConfigurationFile(CLI::App& app);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_OPTION_KINDS_H_
