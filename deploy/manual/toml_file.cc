#include "deploy/manual/toml_file.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string_view>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "deploy/manual/option_row.h"

namespace latvox {
namespace {

using Kind = FileSetting::Kind;

std::string ReadText(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxTomlBytes + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad() || (file.fail() && !file.eof())) {
    throw UsageError(absl::StrCat(path, ": cannot be read (", std::strerror(errno), ")"));
  }
  text.resize(static_cast<size_t>(file.gcount()));
  if (text.size() > kMaxTomlBytes) {
    throw UsageError(absl::StrCat(path, ": exceeds ", kMaxTomlBytes, " bytes, the most that a configuration has"));
  }
  return text;
}

std::string_view NameOf(toml::node_type type) {
  switch (type) {
    case toml::node_type::boolean:
      return "a boolean";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number with a fraction";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

// The shortest text that gives the same number again.
std::string TextOf(double number) {
  char digits[64];
  return {digits, std::to_chars(digits, std::end(digits), number).ptr};
}

void SetText(const toml::array& texts, FileSetting& setting) {
  for (const toml::node& text : texts) {
    if (!text.is_string()) return;
  }
  if (texts.empty()) return;
  setting.kind = Kind::kTexts;
  for (const toml::node& text : texts) setting.words.push_back(**text.as_string());
}

FileSetting SettingOf(std::string_view key, const toml::node& value) {
  FileSetting setting;
  setting.key = key;
  setting.line = value.source().begin.line;
  setting.kind_name = NameOf(value.type());
  const auto set = [&setting](Kind kind, std::string word) {
    setting.kind = kind;
    setting.words = {std::move(word)};
  };
  if (const auto* truth = value.as_boolean()) set(Kind::kTruth, **truth ? "true" : "false");
  if (const auto* integer = value.as_integer()) set(Kind::kInteger, absl::StrCat(**integer));
  if (const auto* number = value.as_floating_point()) set(Kind::kNumber, TextOf(**number));
  if (const auto* text = value.as_string()) set(Kind::kText, **text);
  if (const auto* array = value.as_array()) {
    SetText(*array, setting);
    setting.kind_name = array->empty()                 ? "an empty array"
                        : setting.kind == Kind::kTexts ? "an array of texts"
                                                       : "an array of other values than texts";
  }
  return setting;
}

}  // namespace

std::vector<FileSetting> ReadTomlFile(const std::string& path) try {
  const toml::table table = toml::parse(ReadText(path), path);
  std::vector<FileSetting> settings;
  for (const auto& [key, value] : table) settings.push_back(SettingOf(key.str(), value));
  std::sort(settings.begin(), settings.end(), [](const auto& a, const auto& b) { return a.line < b.line; });
  for (const FileSetting& setting : settings) {
    for (const std::string& word : setting.words) {
      if (!absl::StrContains(word, '\0')) continue;
      throw UsageError(absl::StrCat(path, ":", setting.line, ": ", setting.key, ": \"", absl::Utf8SafeCEscape(word),
                                    "\" has a NUL character"));
    }
  }
  return settings;
} catch (const toml::parse_error& error) {
  throw UsageError(absl::StrCat(path, ":", error.source().begin.line, ": ", std::string(error.description())));
}

}  // namespace latvox
