#include "deploy/manual/help.h"

#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "deploy/manual/option_text.h"

namespace latvox {
namespace {

constexpr size_t kWidth = 100, kColumn = 26;  // `kColumn`: where descriptions begin

std::string HeadOf(const OptionFacts& option) {
  if (option.names.empty()) return absl::StrCat(option.value, option.several ? "..." : "");
  return absl::StrCat(absl::StrJoin(option.names, ", "), option.value.empty() ? "" : " ", option.value);
}

// Breaks a long head after a bar: "--set surface|", "solid".
std::string Broken(absl::string_view head) {
  constexpr size_t kIndent = 6;
  std::string out;
  while (head.size() + kIndent > kWidth) {
    const size_t bar = head.rfind('|', kWidth - kIndent - 1);
    if (bar == absl::string_view::npos) break;
    absl::StrAppend(&out, head.substr(0, bar + 1), "\n", std::string(kIndent, ' '));
    head.remove_prefix(bar + 1);
  }
  return absl::StrCat(out, head);
}

std::string Entry(absl::string_view head, absl::string_view text) {
  std::string entry = absl::StrCat("  ", Broken(head));
  const std::string indent(kColumn, ' ');
  const size_t size = entry.size();
  entry += size + 2 > kColumn ? "\n" + indent : indent.substr(size);
  const std::vector<std::string> words = absl::StrSplit(text, ' ');
  return absl::StrCat(entry, absl::StrJoin(Wrap(words, kWidth - kColumn), "\n" + indent), "\n");
}

}  // namespace

std::string ToHelp(absl::string_view path, const CommandFacts& command) {
  std::string help = absl::StrCat(Capital(command.description), "\n\n");
  std::vector<std::string> usage = UsageOf(absl::StrCat("Usage: ", path), command);
  if (!command.commands.empty()) usage.emplace_back("[COMMAND]");
  absl::StrAppend(&help, absl::StrJoin(Wrap(usage, kWidth - 4), "\n    "), "\n");
  if (!command.positionals.empty()) help += "\nArguments:\n";
  for (const OptionFacts& one : command.positionals) help += Entry(HeadOf(one), DescriptionOf(one));
  for (const auto& [group, options] : GroupsOf(command)) {
    absl::StrAppend(&help, "\n", group, ":\n");
    for (const OptionFacts& option : options) help += Entry(HeadOf(option), DescriptionOf(option));
  }
  if (!command.commands.empty()) help += "\nCommands:\n";
  for (const CommandFacts& one : command.commands) help += Entry(one.name, Capital(one.description));
  if (command.footer.empty()) return help;
  return absl::StrCat(help, "\n", command.footer, absl::EndsWith(command.footer, "\n") ? "" : "\n");
}

}  // namespace latvox
