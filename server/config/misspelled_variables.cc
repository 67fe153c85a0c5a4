#include "server/config/misspelled_variables.h"

#include <unistd.h>

#include <algorithm>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "deploy/manual/nearest_word.h"
#include "server/config/option_kinds.h"

namespace latvox {
namespace {

constexpr absl::string_view kPrefix = "LATVOX_";

// Without the prefix.
std::vector<std::string> VariablesOf(const std::vector<OptionState>& options) {
  std::vector<std::string> names = {EnvironmentName("--config").substr(kPrefix.size())};
  for (const OptionState& option : options) {
    if (!option.environment.empty()) names.push_back(option.environment.substr(kPrefix.size()));
  }
  return names;
}

}  // namespace

std::vector<MisspelledVariable> MisspelledVariables(const std::vector<OptionState>& options) {
  const std::vector<std::string> names = VariablesOf(options);
  std::vector<MisspelledVariable> misspelled;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    absl::string_view name = *variable;
    name = name.substr(0, name.find('='));
    if (!absl::StartsWith(name, kPrefix)) continue;
    const auto nearest = NearestWord(name.substr(kPrefix.size()), names);
    if (!nearest || absl::StrCat(kPrefix, *nearest) == name) continue;
    misspelled.push_back({std::string(name), absl::StrCat(kPrefix, *nearest)});
  }
  std::sort(misspelled.begin(), misspelled.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return misspelled;
}

}  // namespace latvox
