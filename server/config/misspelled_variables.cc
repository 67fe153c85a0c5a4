#include "server/config/misspelled_variables.h"

#include <unistd.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "server/config/option_kinds.h"

namespace latvox {
namespace {

constexpr absl::string_view kPrefix = "LATVOX_";

// The number of letters to leave out, put in or replace [Levenshtein 1966].
size_t Distance(absl::string_view a, absl::string_view b) {
  std::vector<size_t> row(b.size() + 1);  // from the first letters of a to each beginning of b
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i + 1);
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row[b.size()];
}

// True if the longer text begins with the shorter one, or ends with it as words.
bool IsPartOf(absl::string_view a, absl::string_view b) {
  if (a.size() > b.size()) std::swap(a, b);
  return absl::StartsWith(b, a) || absl::EndsWith(b, absl::StrCat("_", a));
}

bool IsLike(absl::string_view name, absl::string_view option, size_t distance) {
  return distance <= 1 + std::min(name.size(), option.size()) / 4 || IsPartOf(name, option);
}

std::vector<std::string> VariablesOf(const std::vector<OptionState>& options) {
  std::vector<std::string> names = {EnvironmentName("--config")};
  for (const OptionState& option : options) {
    if (!option.environment.empty()) names.push_back(option.environment);
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
    const absl::string_view rest = name.substr(kPrefix.size());
    const std::string* nearest = nullptr;
    size_t least = 0;
    for (const std::string& option : names) {
      const absl::string_view words = absl::string_view(option).substr(kPrefix.size());
      const size_t distance = Distance(rest, words);
      if (!IsLike(rest, words, distance) || (nearest != nullptr && distance >= least)) continue;
      nearest = &option;
      least = distance;
    }
    if (nearest != nullptr && least > 0) misspelled.push_back({std::string(name), *nearest});
  }
  std::sort(misspelled.begin(), misspelled.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return misspelled;
}

}  // namespace latvox
