#include "deploy/manual/man_page.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace latvox {
namespace {

constexpr char kDate[] = "2026-11-20";  // of what the pages say beside the options

// Text with nothing in it that troff would read.
std::string Plain(absl::string_view text) {
  std::string plain = absl::StrReplaceAll(text, {{"\\", "\\e"}, {"-", "\\-"}, {"'", "\\(aq"}, {"`", "\\(ga"}});
  // A line that begins like a request.
  return absl::StartsWith(plain, ".") ? absl::StrCat("\\&", plain) : plain;
}

std::string Bold(absl::string_view text) { return absl::StrCat("\\fB", Plain(text), "\\fR"); }
std::string Italic(absl::string_view text) { return absl::StrCat("\\fI", Plain(text), "\\fR"); }

std::string Capital(std::string text) {
  if (!text.empty()) text[0] = absl::ascii_toupper(static_cast<unsigned char>(text[0]));
  return text;
}

// Paragraphs filled, lines that begin with two spaces as examples.
std::string Body(absl::string_view text) {
  std::string body;
  bool example = false;
  while (absl::ConsumePrefix(&text, "\n")) {  // spaces mark an example
  }
  for (const absl::string_view line : absl::StrSplit(absl::StripTrailingAsciiWhitespace(text), '\n')) {
    const bool is_example = absl::StartsWith(line, "  ");
    if (is_example != example) body += is_example ? ".PP\n.EX\n" : ".EE\n.PP\n";
    example = is_example;
    if (line.empty()) {
      body += ".PP\n";
    } else {
      absl::StrAppend(&body, Plain(line), "\n");
    }
  }
  if (example) body += ".EE\n";
  return absl::StrReplaceAll(body, {{".PP\n.PP\n", ".PP\n"}});  // an empty line beside an example
}

// `body` without a paragraph's beginning, which a section's title is itself.
std::string Section(absl::string_view title, absl::string_view body) {
  absl::ConsumePrefix(&body, ".PP\n");
  return absl::StrCat(".SH ", title, "\n", body);
}

std::string ValueOf(const OptionFacts& option) { return option.value.empty() ? "" : " " + Italic(option.value); }

std::string OptionEntry(const OptionFacts& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(Bold(name));
  std::string text = absl::StrCat(Plain(Capital(option.description)));
  if (!option.standard.empty()) absl::StrAppend(&text, " (default: ", Plain(option.standard), ")");
  if (option.required) text += " (required)";
  if (!absl::EndsWith(text, ".")) text += ".";
  if (!option.environment.empty()) absl::StrAppend(&text, "\nEnvironment: ", Bold(option.environment), ".");
  return absl::StrCat(".TP\n", names.empty() ? Italic(option.value) : absl::StrJoin(names, ", ") + ValueOf(option),
                      "\n", text, "\n");
}

std::string Synopsis(absl::string_view program, const CommandFacts& command) {
  std::string line = Bold(program);
  if (!command.options.empty()) absl::StrAppend(&line, " [", Italic("options"), "]");
  for (const OptionFacts& one : command.positionals) {
    absl::StrAppend(&line, " ", Italic(one.value), one.several ? " ..." : "");
  }
  return line + "\n";
}

// All options, those of one group together, in the order in which groups first appear.
std::string Entries(const CommandFacts& command) {
  std::string text;
  for (const OptionFacts& one : command.positionals) text += OptionEntry(one);
  std::vector<std::string> groups;
  for (const OptionFacts& one : command.options) {
    if (std::find(groups.begin(), groups.end(), one.group) == groups.end()) groups.push_back(one.group);
  }
  for (const std::string& group : groups) {
    if (groups.size() > 1) absl::StrAppend(&text, ".PP\n", Italic(group), "\n");
    for (const OptionFacts& one : command.options) {
      if (one.group == group) text += OptionEntry(one);
    }
  }
  return text;
}

std::string Command(absl::string_view program, const CommandFacts& command) {
  const std::string name = absl::StrCat(program, " ", command.name);
  return absl::StrCat(".SS ", Plain(name), "\n", Synopsis(name, command), ".PP\n", Plain(Capital(command.description)),
                      ".\n", Entries(command), command.footer.empty() ? "" : ".PP\n" + Body(command.footer));
}

}  // namespace

std::string ToMan(const CommandFacts& program, const ManPage& page) {
  const std::string& name = program.name;
  std::string text =
      absl::StrCat(".TH ", absl::AsciiStrToUpper(name), " ", page.section, " ", kDate, " \"", name, " ", page.version,
                   "\"\n.SH NAME\n", Plain(name), " \\- ", Plain(program.description), "\n.SH SYNOPSIS\n");
  std::vector<std::string> lines;
  if (program.commands.empty()) lines.push_back(Synopsis(name, program));
  for (const CommandFacts& command : program.commands) {
    lines.push_back(Synopsis(absl::StrCat(name, " ", command.name), command));
  }
  text += absl::StrJoin(lines, ".br\n");
  for (const ManSection& section : page.before) text += Section(section.title, Body(section.text));
  text += Section("OPTIONS", Entries(program));
  if (!program.commands.empty()) text += ".SH COMMANDS\n";
  for (const CommandFacts& command : program.commands) text += Command(name, command);
  for (const ManSection& section : page.after) text += Section(section.title, Body(section.text));
  std::vector<std::string> others;
  for (const std::string& other : page.see_also) {
    const size_t bracket = other.find('(');
    others.push_back(absl::StrCat("\\fB", Plain(other.substr(0, bracket)), "\\fR", other.substr(bracket)));
  }
  if (!others.empty()) absl::StrAppend(&text, ".SH SEE ALSO\n", absl::StrJoin(others, ",\n"), "\n");
  return text;
}

}  // namespace latvox
