// Completions for shells.
#ifndef LATVOX_MANUAL_COMPLETIONS_H_
#define LATVOX_MANUAL_COMPLETIONS_H_

#include <string>

#include "deploy/manual/command_facts.h"

namespace latvox {

// Return scripts that complete the program's commands, their options, and the options' words, files or directories.
// Source the script, or install it where its shell looks: as `NAME` for bash, `_NAME` for zsh, `NAME.fish` for fish.
std::string BashCompletions(const CommandFacts& program);
std::string ZshCompletions(const CommandFacts& program);
std::string FishCompletions(const CommandFacts& program);

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMPLETIONS_H_
