// The error of a word that a command does not know.
#ifndef LATVOX_MANUAL_UNKNOWN_WORD_H_
#define LATVOX_MANUAL_UNKNOWN_WORD_H_

#include <string>

#include "deploy/manual/command_facts.h"

namespace latvox {

// Returns the error of the first word that `command` does not know. It names the option or command that the user may
// have meant, or else the help page, such as "latvox info --help".
std::string UnknownWord(const std::string& word, const CommandFacts& command, const std::string& page);

}  // namespace latvox

#endif  // LATVOX_MANUAL_UNKNOWN_WORD_H_
