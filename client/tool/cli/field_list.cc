#include "client/tool/cli/field_list.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace latvox::client {
namespace {

constexpr char kNoFields[] = "none";

}  // namespace

WrongWord CheckFieldList(const std::string& text) {
  if (text == kNoFields) return "";
  std::vector<absl::string_view> seen;
  for (const absl::string_view word : absl::StrSplit(text, ',')) {
    const auto has_name = [word](const FieldFacts& facts) { return word == facts.name; };
    if (word == kNoFields) return {"\"none\" stands alone, without fields", kNoFields};
    if (std::none_of(kFields.begin(), kFields.end(), has_name)) {
      return {absl::StrCat("\"", word, "\" is neither none nor a field"), std::string(word)};
    }
    if (std::find(seen.begin(), seen.end(), word) != seen.end()) {
      return {absl::StrCat("\"", word, "\" is given twice"), std::string(word)};
    }
    seen.push_back(word);
  }
  return "";
}

std::vector<Field> ParseFieldList(const std::string& text) {
  std::vector<Field> fields;
  for (const absl::string_view word : absl::StrSplit(text, ',')) {
    for (const FieldFacts& facts : kFields) {
      if (word == facts.name) fields.push_back(facts.field);
    }
  }
  return fields;
}

}  // namespace latvox::client
