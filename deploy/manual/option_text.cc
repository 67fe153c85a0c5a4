#include "deploy/manual/option_text.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace latvox {
namespace {

bool IsHelp(const OptionFacts& option) {
  return std::find(option.names.begin(), option.names.end(), "--help") != option.names.end();
}

}  // namespace

std::string Capital(absl::string_view text) {
  std::string capital(text);
  if (!capital.empty()) capital[0] = absl::ascii_toupper(static_cast<unsigned char>(capital[0]));
  return capital;
}

std::string DescriptionOf(const OptionFacts& option) {
  std::vector<std::string> notes;
  if (option.required && !option.names.empty()) notes.emplace_back("required");
  if (!option.range.empty()) notes.push_back(option.range);
  if (!option.standard.empty()) notes.push_back(absl::StrCat("default: ", option.standard));
  const std::string text = Capital(option.description);
  return notes.empty() ? text : absl::StrCat(text, " (", absl::StrJoin(notes, "; "), ")");
}

std::vector<std::string> UsageOf(absl::string_view path, const CommandFacts& command) {
  std::vector<std::string> words{std::string(path)};
  for (const OptionFacts& one : command.positionals) {
    const std::string word = absl::StrCat(one.value, one.several ? "..." : "");
    words.push_back(one.required ? word : absl::StrCat("[", word, "]"));
  }
  bool others = false;
  for (const OptionFacts& option : command.options) {
    if (option.required) {
      words.push_back(absl::StrCat(option.names.front(), " ", option.value));
    } else {
      others |= !IsHelp(option);
    }
  }
  if (others) words.emplace_back("[OPTIONS]");
  return words;
}

std::vector<std::pair<std::string, std::vector<OptionFacts>>> GroupsOf(const CommandFacts& command) {
  std::vector<std::pair<std::string, std::vector<OptionFacts>>> groups;
  for (const OptionFacts& option : command.options) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& one) { return one.first == option.group; });
    if (group == groups.end()) group = groups.insert(groups.end(), {option.group, {}});
    group->second.push_back(option);
  }
  std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return !IsHelp(group.second.front()); });
  return groups;
}

std::vector<std::string> Wrap(const std::vector<std::string>& words, size_t width) {
  std::vector<std::string> lines;
  for (const std::string& word : words) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > width) {
      lines.push_back(word);
    } else {
      absl::StrAppend(&lines.back(), " ", word);
    }
  }
  return lines;
}

}  // namespace latvox
