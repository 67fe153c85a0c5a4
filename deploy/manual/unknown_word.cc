#include "deploy/manual/unknown_word.h"

#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "deploy/manual/nearest_word.h"

namespace latvox {
namespace {

using Words = std::vector<std::string>;

Words LongNames(const CommandFacts& command) {
  Words names;
  for (const OptionFacts& option : command.options) {
    for (const std::string& name : option.names) {
      if (absl::StartsWith(name, "--")) names.push_back(name.substr(2));
    }
  }
  return names;
}

Words CommandNames(const CommandFacts& program) {
  Words names;
  for (const CommandFacts& command : program.commands) names.push_back(command.name);
  return names;
}

}  // namespace

std::string UnknownWord(const std::string& word, const CommandFacts& command, const std::string& page) {
  const bool is_option = absl::StartsWith(word, "-");
  const bool is_command = !is_option && !command.commands.empty();
  const auto nearest = NearestWord(absl::StripPrefix(absl::StripPrefix(word, "-"), "-"),
                                   is_option ? LongNames(command) : CommandNames(command));
  return absl::StrCat(
      is_option    ? "unknown option "
      : is_command ? "unknown command "
                   : "unexpected argument ",
      "\"", word, "\"; ",
      nearest ? absl::StrCat("did you mean ", is_option ? "--" : "", *nearest, "?") : absl::StrCat("see ", page));
}

}  // namespace latvox
