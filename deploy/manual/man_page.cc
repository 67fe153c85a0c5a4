#include "deploy/manual/man_page.h"

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

constexpr char kDate[] = "2026-11-20";  // of the pages' own text

// Escapes the characters that troff would interpret.
std::string Escaped(absl::string_view text) {
  std::string plain = absl::StrReplaceAll(text, {{"\\", "\\e"}, {"-", "\\-"}, {"'", "\\(aq"}, {"`", "\\(ga"}});
  // A leading dot would be a request.
  return absl::StartsWith(plain, ".") ? absl::StrCat("\\&", plain) : plain;
}

std::string Bold(absl::string_view text) { return absl::StrCat("\\fB", Escaped(text), "\\fR"); }
std::string Italic(absl::string_view text) { return absl::StrCat("\\fI", Escaped(text), "\\fR"); }

// Formats paragraphs. Lines that begin with two spaces are examples.
std::string TroffBody(absl::string_view text) {
  std::string body;
  bool example = false;
  while (absl::ConsumePrefix(&text, "\n")) {  // spaces must stay: they mark an example
  }
  for (const absl::string_view line : absl::StrSplit(absl::StripTrailingAsciiWhitespace(text), '\n')) {
    const bool is_example = absl::StartsWith(line, "  ");
    if (is_example != example) body += is_example ? ".PP\n.EX\n" : ".EE\n.PP\n";
    example = is_example;
    if (line.empty()) {
      body += ".PP\n";
    } else {
      absl::StrAppend(&body, Escaped(line), "\n");
    }
  }
  if (example) body += ".EE\n";
  return absl::StrReplaceAll(body, {{".PP\n.PP\n", ".PP\n"}});  // an empty line beside an example
}

// A section's title begins a paragraph itself.
std::string Section(absl::string_view title, absl::string_view body) {
  absl::ConsumePrefix(&body, ".PP\n");
  return absl::StrCat(".SH ", title, "\n", body);
}

std::string ValueOf(const OptionFacts& option) { return option.value.empty() ? "" : " " + Italic(option.value); }

// "Not with --lattice, --align."
std::string Related(absl::string_view relation, const std::vector<std::string>& names) {
  std::vector<std::string> bold;
  for (const std::string& name : names) bold.push_back(Bold(name));
  return names.empty() ? "" : absl::StrCat("\n", relation, " ", absl::StrJoin(bold, ", "), ".");
}

std::string OptionEntry(const OptionFacts& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(Bold(name));
  std::string text = Escaped(DescriptionOf(option));
  if (!absl::EndsWith(text, ".")) text += ".";
  absl::StrAppend(&text, Related("Not with", option.excludes), Related("Requires", option.needs));
  if (!option.environment.empty()) absl::StrAppend(&text, "\nEnvironment: ", Bold(option.environment), ".");
  return absl::StrCat(".TP\n", names.empty() ? Italic(option.value) : absl::StrJoin(names, ", ") + ValueOf(option),
                      "\n", text, "\n");
}

std::string Synopsis(absl::string_view path, const CommandFacts& command) {
  std::vector<std::string> words = UsageOf(path, command);
  words.front() = Bold(path);
  for (size_t n = 1; n < words.size(); ++n) words[n] = Escaped(words[n]);
  return absl::StrJoin(words, " ") + "\n";
}

std::string Entries(const CommandFacts& command) {
  std::string text;
  for (const OptionFacts& one : command.positionals) text += OptionEntry(one);
  const auto groups = GroupsOf(command);
  for (const auto& [group, options] : groups) {
    if (groups.size() > 1) absl::StrAppend(&text, ".PP\n", Italic(group), "\n");
    for (const OptionFacts& one : options) text += OptionEntry(one);
  }
  return text;
}

std::string Command(absl::string_view program, const CommandFacts& command) {
  const std::string name = absl::StrCat(program, " ", command.name);
  return absl::StrCat(".SS ", Escaped(name), "\n", Synopsis(name, command), ".PP\n",
                      Escaped(Capital(command.description)), ".\n", Entries(command),
                      command.footer.empty() ? "" : ".PP\n" + TroffBody(command.footer));
}

}  // namespace

std::string ToMan(const CommandFacts& program, const ManPage& page) {
  const std::string& name = program.name;
  std::string text =
      absl::StrCat(".TH ", absl::AsciiStrToUpper(name), " ", page.section, " ", kDate, " \"", name, " ", page.version,
                   "\"\n.SH NAME\n", Escaped(name), " \\- ", Escaped(program.description), "\n.SH SYNOPSIS\n");
  std::vector<std::string> lines;
  if (program.commands.empty()) lines.push_back(Synopsis(name, program));
  for (const CommandFacts& command : program.commands) {
    lines.push_back(Synopsis(absl::StrCat(name, " ", command.name), command));
  }
  text += absl::StrJoin(lines, ".br\n");
  for (const ManSection& section : page.before) text += Section(section.title, TroffBody(section.text));
  text += Section("OPTIONS", Entries(program));
  if (!program.commands.empty()) text += ".SH COMMANDS\n";
  for (const CommandFacts& command : program.commands) text += Command(name, command);
  for (const ManSection& section : page.after) text += Section(section.title, TroffBody(section.text));
  std::vector<std::string> others;
  for (const std::string& other : page.see_also) {
    const size_t bracket = other.find('(');
    others.push_back(absl::StrCat("\\fB", Escaped(other.substr(0, bracket)), "\\fR", other.substr(bracket)));
  }
  if (!others.empty()) absl::StrAppend(&text, ".SH SEE ALSO\n", absl::StrJoin(others, ",\n"), "\n");
  return text;
}

}  // namespace latvox
