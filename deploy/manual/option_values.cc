#include "deploy/manual/option_values.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <type_traits>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "deploy/manual/nearest_word.h"

namespace latvox {
namespace {

struct LargestOfTarget {
  template <class T>
  uint64_t operator()(T*) const {
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) return std::numeric_limits<T>::max();
    return 0;
  }
  uint64_t operator()(std::optional<int>*) const { return std::numeric_limits<int>::max(); }
  uint64_t operator()(const std::function<void(const std::string&)>&) const { return 0; }
};

using Kind = FileSetting::Kind;

// The kinds of values that a key of the configuration file may have, and their name for people.
struct Kinds {
  std::vector<Kind> kinds;
  std::string name;
};

struct KindsInFile {
  const OptionRow& row;

  Kinds operator()(bool*) const { return {{Kind::kTruth}, "true or false"}; }
  Kinds operator()(std::optional<bool>*) const { return {{Kind::kTruth}, "true or false"}; }
  Kinds operator()(std::string*) const { return {{Kind::kText}, "a text"}; }
  Kinds operator()(std::vector<std::string>*) const {
    return {{Kind::kText, Kind::kTexts}, "a text or an array of texts"};
  }
  Kinds operator()(const std::function<void(const std::string&)>&) const {
    if (row.is_number) return Number();
    return {{Kind::kText},
            row.words.empty() ? "a text" : absl::StrCat("one of the texts ", absl::StrJoin(row.words, ", "))};
  }
  Kinds operator()(std::optional<double>*) const { return Number(); }
  template <class T>
  Kinds operator()(T*) const {
    if (row.is_size) return {{Kind::kInteger, Kind::kText}, "a whole number, or a text such as \"1GiB\""};
    return {{Kind::kInteger}, "a whole number"};
  }

 private:
  static Kinds Number() { return {{Kind::kInteger, Kind::kNumber}, "a number"}; }
};

const OptionRow& RowOf(const std::string& key, const RowsOfKeys& rows, const std::string& place) {
  const auto found = rows.find(key);
  if (found != rows.end() && found->second->in_file) return *found->second;
  if (found != rows.end()) throw UsageError(absl::StrCat(place, key, ": may only stand on the command line"));
  std::vector<std::string> keys;
  for (const auto& [known, row] : rows) {
    if (row->in_file) keys.push_back(known);
  }
  const auto nearest = NearestWord(key, keys);
  throw UsageError(absl::StrCat(place, "unknown key \"", absl::Utf8SafeCEscape(key), "\"",
                                nearest ? absl::StrCat("; did you mean ", *nearest, "?") : ""));
}

// Returns the name that help gives to a value, such as N, where its row has neither a name nor a list of words.
struct Placeholder {
  std::string operator()(bool*) const { return ""; }
  std::string operator()(std::optional<bool>*) const { return ""; }
  std::string operator()(std::string*) const { return "TEXT"; }
  std::string operator()(std::vector<std::string>*) const { return "TEXT"; }
  std::string operator()(const std::function<void(const std::string&)>&) const { return "TEXT"; }
  template <class T>
  std::string operator()(T*) const {
    return "N";
  }
};

std::string StandardOf(const OptionRow& row) {
  absl::string_view text = row.standard;
  if (absl::ConsumePrefix(&text, "[")) absl::ConsumeSuffix(&text, "]");
  return row.is_size ? SizeText(std::string(text)) : std::string(text);
}

}  // namespace

uint64_t MostOf(const OptionRow& row) {
  constexpr uint64_t kMostInFile = std::numeric_limits<int64_t>::max();
  return row.most != 0 ? row.most : std::min(std::visit(LargestOfTarget{}, row.target), kMostInFile);
}

std::string AboveMost(const std::string& word, uint64_t most) {
  const bool is_number =
      !word.empty() && std::all_of(word.begin(), word.end(), [](char c) { return absl::ascii_isdigit(c); });
  uint64_t number = 0;
  if (!is_number || (absl::SimpleAtoi(word, &number) && number <= most)) return "";
  return absl::StrCat(word, " exceeds ", most);
}

std::string ToTruth(std::string& word) {
  for (const auto& [known, truth] : {std::pair("true", true),
                                     {"on", true},
                                     {"yes", true},
                                     {"1", true},
                                     {"false", false},
                                     {"off", false},
                                     {"no", false},
                                     {"0", false}}) {
    if (absl::EqualsIgnoreCase(word, known)) return word = truth ? "true" : "false", "";
  }
  return absl::StrCat("\"", word, "\" is not true or false");
}

std::string ToListed(const std::vector<std::string>& words, std::string& word) {
  for (const std::string& known : words) {
    if (absl::EqualsIgnoreCase(word, known)) return word = known, "";
  }
  return absl::StrCat("\"", word, "\" is not one of ", absl::StrJoin(words, ", "));
}

WrongWord FindWrong(const OptionRow& row, const std::string& word) {
  const auto is_it = [&word](const std::string& known) { return absl::EqualsIgnoreCase(word, known); };
  if (!row.words.empty() && std::none_of(row.words.begin(), row.words.end(), is_it)) {
    return {"is not one of the words", word, absl::StrJoin(row.words, ", ")};
  }
  for (const OptionCheck& check : row.checks) {
    WrongWord wrong = check.wrong(word);
    if (wrong.text.empty()) continue;
    if (wrong.value.empty()) wrong.value = word;
    if (wrong.limit.empty()) wrong.limit = check.range;
    return wrong;
  }
  const uint64_t most = MostOf(row);
  return {most == 0 ? "" : AboveMost(word, most), word, absl::StrCat(most)};
}

std::string SizeText(const std::string& bytes) {
  uint64_t number = 0;
  if (!absl::SimpleAtoi(bytes, &number) || number == 0) return bytes;
  size_t unit = 0;
  constexpr const char* kUnits[] = {"", "KiB", "MiB", "GiB", "TiB"};
  for (; number % 1024 == 0 && unit + 1 < std::size(kUnits); number /= 1024) ++unit;
  return absl::StrCat(number, kUnits[unit]);
}

void DescribeValue(const OptionRow& row, OptionFacts& facts) {
  facts.choices = row.words;
  facts.choice_help = row.word_help;
  facts.value = !row.words.empty()   ? absl::StrJoin(row.words, "|")
                : !row.value.empty() ? row.value
                : row.is_size        ? "SIZE"
                                     : std::visit(Placeholder{}, row.target);
  facts.standard = StandardOf(row);
  for (const OptionCheck& check : row.checks) {
    if (!check.range.empty()) facts.range = check.range;
  }
}

std::string ValueOfVariable(const std::string& name) {
  const char* value = name.empty() ? nullptr : std::getenv(name.c_str());
  return value == nullptr ? "" : value;
}

bool IsText(const OptionRow& row) {
  const std::vector<Kind> kinds = std::visit(KindsInFile{row}, row.target).kinds;
  return !row.is_size && std::find(kinds.begin(), kinds.end(), Kind::kText) != kinds.end();
}

std::vector<FileSetting> ReadSettings(const std::string& path, const RowsOfKeys& rows) {
  std::vector<FileSetting> settings = ReadTomlFile(path);
  for (const FileSetting& setting : settings) {
    const std::string place = absl::StrCat(path, ":", setting.line, ": ");
    const OptionRow& row = RowOf(setting.key, rows, place);
    const Kinds expected = std::visit(KindsInFile{row}, row.target);
    if (std::find(expected.kinds.begin(), expected.kinds.end(), setting.kind) != expected.kinds.end()) continue;
    const std::string value = absl::Utf8SafeCEscape(absl::StrJoin(setting.words, ", "));
    throw UsageError(absl::StrCat(place, setting.key, ": ", value, value.empty() ? "" : " ", "is ", setting.kind_name,
                                  ", not ", expected.name));
  }
  return settings;
}

}  // namespace latvox
