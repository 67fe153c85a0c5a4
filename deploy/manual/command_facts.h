// Facts about a command's options, for help texts, pages and completions. CommandParser::Describe returns them.
#ifndef LATVOX_MANUAL_COMMAND_FACTS_H_
#define LATVOX_MANUAL_COMMAND_FACTS_H_

#include <string>
#include <vector>

namespace latvox {

struct OptionFacts {
  std::vector<std::string> names;        // "-o", "--out"; empty for a positional option
  std::string value;                     // the name of its value: "FILE", "N", "a|b"; empty for a flag
  std::vector<std::string> choices;      // all words that it accepts; empty if there are too many to list
  std::vector<std::string> choice_help;  // of each of `choices`
  std::string description, group, environment;
  std::string range;                  // of its value: "2 to 65536"; or empty
  std::string standard;               // default value; empty if there is none
  std::vector<std::string> excludes;  // long names of options that it cannot be combined with
  std::vector<std::string> needs;     // long names of options that must be given with it
  bool required = false;
  bool several = false;  // may be given, or takes words, more than once
};

struct CommandFacts {
  std::string name, description, footer;
  std::vector<OptionFacts> positionals, options;  // in the order of definition, --help first; no hidden ones
  std::vector<CommandFacts> commands;
};

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMMAND_FACTS_H_
