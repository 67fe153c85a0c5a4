#include "deploy/manual/nearest_word.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

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

// Returns whether the longer text begins with the shorter one, or ends with it as words.
bool IsPartOf(absl::string_view a, absl::string_view b) {
  if (a.size() > b.size()) std::swap(a, b);
  return absl::StartsWith(b, a) || absl::EndsWith(b, absl::StrCat("-", a));
}

std::string Normal(absl::string_view word) {
  std::string normal = absl::AsciiStrToLower(word);
  std::replace(normal.begin(), normal.end(), '_', '-');
  return normal;
}

}  // namespace

std::optional<std::string> NearestWord(absl::string_view word, const std::vector<std::string>& words) {
  const std::string given = Normal(word);
  const std::string* nearest = nullptr;
  size_t least = 0;
  for (const std::string& candidate : words) {
    const std::string known = Normal(candidate);
    const size_t distance = Distance(given, known);
    const bool is_like = distance <= 1 + std::min(given.size(), known.size()) / 4 || IsPartOf(given, known);
    if (!is_like || (nearest != nullptr && distance >= least)) continue;
    nearest = &candidate;
    least = distance;
  }
  return nearest == nullptr ? std::nullopt : std::optional(*nearest);
}

}  // namespace latvox
