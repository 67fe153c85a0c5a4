// What a command's options are, for those who write about them: CommandParser::Describe makes it.
#ifndef LATVOX_MANUAL_COMMAND_FACTS_H_
#define LATVOX_MANUAL_COMMAND_FACTS_H_

#include <string>
#include <vector>

namespace latvox {

struct OptionFacts {
  std::vector<std::string> names;                         // "-o", "--out"; of a positional one none
  std::string value;                                      // what stands for it: "FILE", "N"; empty: a flag takes none
  std::vector<std::string> choices;                       // all words that it may be, if they are few
  std::string description, group, environment, standard;  // `standard`: what it is if it is not given, if that is known
  bool required = false;
  bool several = false;  // may be given, or take words, more than once
};

struct CommandFacts {
  std::string name, description, footer;
  std::vector<OptionFacts> positionals, options;  // in the order of definition, --help first; none that is hidden
  std::vector<CommandFacts> commands;
};

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMMAND_FACTS_H_
