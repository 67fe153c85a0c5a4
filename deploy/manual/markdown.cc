#include "deploy/manual/markdown.h"

#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "deploy/manual/option_text.h"

namespace latvox {
namespace {

constexpr size_t kPageWidth = 120;

std::string Code(absl::string_view text) { return absl::StrCat("`", text, "`"); }

// Returns the text with options, variables and files as code, so that Markdown does not change their characters.
std::string Marked(absl::string_view text) {
  std::vector<std::string> words;
  for (absl::string_view word : absl::StrSplit(text, ' ')) {
    const absl::string_view whole = word;
    absl::ConsumePrefix(&word, "(");
    absl::string_view end = word;
    while (!end.empty() && absl::StrContains(",.;:)", end.back())) end.remove_suffix(1);
    const bool is_option = absl::StartsWith(end, "-") && end.size() > 1;
    const bool is_extension = absl::StartsWith(end, ".") && end.size() > 2;
    const bool is_code = is_option || is_extension || absl::StartsWith(end, "$") || absl::StrContains(end, "_") ||
                         absl::StrContains(end, "[");
    words.push_back(
        !is_code ? std::string(whole)
                 : absl::StrCat(whole.substr(0, whole.size() - word.size()), Code(end), word.substr(end.size())));
  }
  return absl::StrJoin(words, " ");
}

// Returns the text in lines. All but the first begin with `indent`.
std::string Filled(absl::string_view text, absl::string_view indent) {
  const std::vector<std::string> words = absl::StrSplit(text, ' ', absl::SkipEmpty());
  return absl::StrCat(absl::StrJoin(Wrap(words, kPageWidth - indent.size()), absl::StrCat("\n", indent)), "\n");
}

// Paragraphs filled; lines that begin with two spaces as blocks of code.
std::string Paragraphs(absl::string_view text) {
  std::string body, paragraph;
  bool code = false;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) absl::StrAppend(&body, Filled(Marked(paragraph), ""), "\n");
    paragraph.clear();
  };
  for (absl::string_view line : absl::StrSplit(absl::StripTrailingAsciiWhitespace(text), '\n')) {
    const bool is_code = absl::ConsumePrefix(&line, "  ");
    if (is_code != code) {
      end_paragraph();
      body += is_code ? "```sh\n" : "```\n\n";
    }
    code = is_code;
    if (is_code) {
      absl::StrAppend(&body, line, "\n");
    } else if (line.empty()) {
      end_paragraph();
    } else {
      absl::StrAppend(&paragraph, paragraph.empty() ? "" : " ", line);
    }
  }
  end_paragraph();
  return code ? body + "```\n\n" : body;
}

std::string Named(absl::string_view relation, const std::vector<std::string>& names) {
  std::vector<std::string> codes;
  for (const std::string& name : names) codes.push_back(Code(name));
  return names.empty() ? "" : absl::StrCat(" ", relation, " ", absl::StrJoin(codes, ", "), ".");
}

std::string Item(const OptionFacts& option) {
  std::string head = absl::StrJoin(option.names, ", ");
  if (!option.value.empty()) absl::StrAppend(&head, head.empty() ? "" : " ", option.value);
  if (option.names.empty() && option.several) head += "...";
  // The head stays in one line: a line break within code would be a space.
  std::vector<std::string> words{absl::StrCat("- ", Code(head), ":")};
  const std::string text = absl::StrCat(Marked(DescriptionOf(option)), ".", Named("Not with", option.excludes),
                                        Named("Requires", option.needs));
  for (const absl::string_view word : absl::StrSplit(text, ' ')) words.emplace_back(word);
  return absl::StrCat(absl::StrJoin(Wrap(words, kPageWidth - 2), "\n  "), "\n");
}

std::string Items(const std::vector<OptionFacts>& options) {
  std::string items;
  for (const OptionFacts& option : options) items += Item(option);
  return items;
}

std::string Section(absl::string_view path, const CommandFacts& command) {
  std::string text =
      absl::StrCat("## ", path, "\n\n", Filled(absl::StrCat(Marked(Capital(command.description)), "."), ""),
                   "\n```sh\n", absl::StrJoin(Wrap(UsageOf(path, command), kPageWidth), "\n    "), "\n```\n\n");
  if (!command.positionals.empty()) absl::StrAppend(&text, "Arguments:\n\n", Items(command.positionals), "\n");
  for (auto [group, options] : GroupsOf(command)) {
    std::erase_if(options, [](const OptionFacts& option) { return option.names.back() == "--help"; });
    if (!options.empty()) absl::StrAppend(&text, group, ":\n\n", Items(options), "\n");
  }
  return text + Paragraphs(command.footer);
}

}  // namespace

std::string ToMarkdown(const CommandFacts& program, const ManPage& page) {
  std::string text =
      absl::StrCat("# Command line of ", program.name, "\n\n`", program.name,
                   " man markdown` writes this page. Every command has `--help`.\n\n", Items(program.options), "\n");
  for (const CommandFacts& command : program.commands) {
    text += Section(absl::StrCat(program.name, " ", command.name), command);
  }
  for (const ManSection& section : page.after) {
    absl::StrAppend(&text, "## ", Capital(absl::AsciiStrToLower(section.title)), "\n\n", Paragraphs(section.text));
  }
  return absl::StrCat(absl::StripTrailingAsciiWhitespace(text), "\n");
}

}  // namespace latvox
