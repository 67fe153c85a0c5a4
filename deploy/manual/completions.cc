#include "deploy/manual/completions.h"

#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace latvox {
namespace {

enum class Wants { kNothing, kWords, kFile, kDirectory, kOther };

// Judges by the placeholder: files are called FILE, MESH, OUT or INPUT, or have an extension.
Wants WantsOf(const OptionFacts& option) {
  if (option.value.empty()) return Wants::kNothing;
  if (!option.choices.empty()) return Wants::kWords;
  if (option.value == "DIR") return Wants::kDirectory;
  for (const char* name : {"FILE", "MESH", "OUT", "INPUT"}) {
    if (option.value == name) return Wants::kFile;
  }
  return absl::StrContains(option.value, '.') && !absl::StrContains(option.value, "..") ? Wants::kFile : Wants::kOther;
}

std::vector<std::string> NamesOf(const std::vector<CommandFacts>& commands) {
  std::vector<std::string> names;
  for (const CommandFacts& command : commands) names.push_back(command.name);
  return names;
}

// Quotes the text as one word for any of the shells.
std::string Quoted(absl::string_view text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", "'\\''"}}), "'");
}

bool TakesFiles(const CommandFacts& command) {
  for (const OptionFacts& one : command.positionals) {
    if (WantsOf(one) == Wants::kFile) return true;
  }
  return false;
}

std::string WordsOfPositionals(const CommandFacts& command) {
  std::vector<std::string> words;
  for (const OptionFacts& one : command.positionals) words.insert(words.end(), one.choices.begin(), one.choices.end());
  return absl::StrJoin(words, " ");
}

// Returns the case of one command: completions after each option, then completions of a new word.
std::string BashCommand(const CommandFacts& command) {
  std::string values, options;
  for (const OptionFacts& option : command.options) {
    absl::StrAppend(&options, options.empty() ? "" : " ", absl::StrJoin(option.names, " "));
    const Wants wants = WantsOf(option);
    if (wants == Wants::kNothing) continue;
    const std::string action = wants == Wants::kWords
                                   ? absl::StrCat("_@name_words ", Quoted(absl::StrJoin(option.choices, " ")))
                               : wants == Wants::kFile      ? "_@name_files -f"
                               : wants == Wants::kDirectory ? "_@name_files -d"
                                                            : ":";
    absl::StrAppend(&values, "        ", absl::StrJoin(option.names, "|"), ") ", action, "; return ;;\n");
  }
  const std::string words = WordsOfPositionals(command);
  const std::string other = !words.empty()        ? absl::StrCat("_@name_words ", Quoted(words))
                            : TakesFiles(command) ? "_@name_files -f"
                                                  : ":";
  return absl::StrCat("    ", command.name, ")\n      case $option in\n", values, "      esac\n",
                      "      if [[ $word == -* ]]; then _@name_words ", Quoted(options), "; else ", other, "; fi ;;\n");
}

std::string ZshText(absl::string_view text) {
  return absl::StrReplaceAll(text, {{"'", "'\\''"}, {"[", "\\["}, {"]", "\\]"}, {":", "\\:"}});
}

std::string ZshAction(const OptionFacts& option) {
  switch (WantsOf(option)) {
    case Wants::kWords: {
      std::string words;
      for (size_t n = 0; n < option.choices.size(); ++n) {
        const std::string help = n < option.choice_help.size() ? ZshText(option.choice_help[n]) : "";
        absl::StrAppend(&words, n == 0 ? "" : " ", option.choices[n], "\\:\"", help, "\"");
      }
      return absl::StrCat("((", words, "))");
    }
    case Wants::kFile:
      return "_files";
    case Wants::kDirectory:
      return "_files -/";
    case Wants::kNothing:
    case Wants::kOther:
      break;
  }
  return " ";
}

std::string ZshCommand(const CommandFacts& command) {
  std::string lines;
  for (const OptionFacts& option : command.options) {
    const std::string value =
        option.value.empty() ? "" : absl::StrCat(":", ZshText(option.value), ":", ZshAction(option));
    for (const std::string& name : option.names) {
      const char* const several = option.several ? "*" : "";
      absl::StrAppend(&lines, " \\\n        '", several, name, "[", ZshText(option.description), "]", value, "'");
    }
  }
  for (const OptionFacts& one : command.positionals) {
    absl::StrAppend(&lines, " \\\n        '", one.several ? "*" : "", ":", ZshText(one.value), ":", ZshAction(one),
                    "'");
  }
  return absl::StrCat("      ", command.name, ")\n        _arguments", lines, " ;;\n");
}

// Quotes the text as one word for fish, which knows \' in quotes.
std::string FishQuoted(absl::string_view text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"'", "\\'"}}), "'");
}

// Returns the words for fish, which expands them like a command line: each with its help after a tab.
std::string FishWords(const OptionFacts& option) {
  std::vector<std::string> words = option.choices;
  for (size_t n = 0; n < option.choice_help.size(); ++n) {
    absl::StrAppend(&words[n], R"(\t)", "\"", option.choice_help[n], "\"");
  }
  return FishQuoted(absl::StrJoin(words, " "));
}

std::string FishOption(const std::string& start, const OptionFacts& option) {
  std::string line = start;
  for (const std::string& name : option.names) {
    const bool is_long = absl::StartsWith(name, "--");
    absl::StrAppend(&line, is_long ? " -l " : " -s ", name.substr(is_long ? 2 : 1));
  }
  switch (WantsOf(option)) {
    case Wants::kWords:
      absl::StrAppend(&line, " -x -a ", FishWords(option));
      break;
    case Wants::kFile:
      line += " -r -F";
      break;
    case Wants::kDirectory:
      line += " -x -a '(__fish_complete_directories)'";
      break;
    case Wants::kOther:
      line += " -x";
      break;
    case Wants::kNothing:
      break;
  }
  return absl::StrCat(line, " -d ", FishQuoted(option.description), "\n");
}

}  // namespace

std::string BashCompletions(const CommandFacts& program) {
  const std::string commands = absl::StrJoin(NamesOf(program.commands), "|");
  std::string cases;
  for (const CommandFacts& command : program.commands) cases += BashCommand(command);
  std::vector<std::string> options;
  for (const OptionFacts& option : program.options) options.push_back(absl::StrJoin(option.names, " "));
  const std::string script = absl::StrReplaceAll(R"sh(# bash completion for @name

# Both functions read the caller's `word`.
_@name_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_@name_files() {
  mapfile -t COMPREPLY < <(compgen "$1" -- "$word")
  compopt -o filenames 2>/dev/null
}

_@name() {
  local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD-1]} command= n
  # --option=word comes as three words.
  if [[ $word == = ]]; then
    word=
  elif [[ $option == = && $COMP_CWORD -gt 1 ]]; then
    option=${COMP_WORDS[COMP_CWORD-2]}
  fi
  COMPREPLY=()
  for ((n = 1; n < COMP_CWORD; ++n)); do
    case ${COMP_WORDS[n]} in
      @commands) command=${COMP_WORDS[n]}; break ;;
    esac
  done
  case $command in
@cases    *) if [[ $word == -* ]]; then _@name_words '@options'; else _@name_words '@words'; fi ;;
  esac
}
complete -F _@name @name
)sh",
                                                 {{"@commands", commands},
                                                  {"@cases", cases},
                                                  {"@options", absl::StrJoin(options, " ")},
                                                  {"@words", absl::StrJoin(NamesOf(program.commands), " ")}});
  return absl::StrReplaceAll(script, {{"@name", program.name}});
}

std::string ZshCompletions(const CommandFacts& program) {
  std::string commands, cases;
  for (const CommandFacts& command : program.commands) {
    absl::StrAppend(&commands, "\n    '", command.name, ":", ZshText(command.description), "'");
    cases += ZshCommand(command);
  }
  return absl::StrReplaceAll(R"sh(#compdef @name

_@name() {
  local context state state_descr line
  typeset -A opt_args
  local -a commands=(@commands
  )
  _arguments -C '(- *)'{-h,--help}'[help]' '(- *)--version[the version]' '1: :->command' '*:: :->words'
  case $state in
    command) _describe command commands ;;
    words)
      case $words[1] in
@cases      esac ;;
  esac
}

if [[ $funcstack[1] == _@name ]]; then
  _@name "$@"
else
  compdef _@name @name
fi
)sh",
                             {{"@name", program.name}, {"@commands", commands}, {"@cases", cases}});
}

std::string FishCompletions(const CommandFacts& program) {
  const std::string start = absl::StrCat("complete -c ", program.name);
  std::string text = absl::StrCat("# fish completion for ", program.name, "\n", start, " -f\n");
  for (const OptionFacts& option : program.options) text += FishOption(start + " -n __fish_use_subcommand", option);
  for (const CommandFacts& command : program.commands) {
    absl::StrAppend(&text, start, " -n __fish_use_subcommand -a ", command.name, " -d ", Quoted(command.description),
                    "\n");
    const std::string within = absl::StrCat(start, " -n '__fish_seen_subcommand_from ", command.name, "'");
    for (const OptionFacts& option : command.options) text += FishOption(within, option);
    for (const OptionFacts& one : command.positionals) {
      if (!one.choices.empty()) absl::StrAppend(&text, within, " -a ", FishWords(one), "\n");
    }
    if (TakesFiles(command)) absl::StrAppend(&text, within, " -F\n");
  }
  return text;
}

}  // namespace latvox
