// Completions for shells.
#ifndef LATVOX_MANUAL_COMPLETIONS_H_
#define LATVOX_MANUAL_COMPLETIONS_H_

#include <string>

#include "deploy/manual/command_facts.h"

namespace latvox {

// Scripts that complete the program's commands, their options, and these options' words, files or directories. Each is
// sourced, or lies where its shell looks for it: `NAME` for bash, `_NAME` for zsh, `NAME.fish` for fish.
std::string BashCompletions(const CommandFacts& program);
std::string ZshCompletions(const CommandFacts& program);
std::string FishCompletions(const CommandFacts& program);

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMPLETIONS_H_
