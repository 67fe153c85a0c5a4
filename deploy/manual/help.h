// Help texts.
#ifndef LATVOX_MANUAL_HELP_H_
#define LATVOX_MANUAL_HELP_H_

#include <string>

#include "absl/strings/string_view.h"
#include "deploy/manual/command_facts.h"

namespace latvox {

// Returns the text of --help, in lines of at most 100 characters: description, usage, arguments, options by group,
// commands, footer. The footer's lines stay as they are.
//   path   words that call the command: "latvox slice"
std::string ToHelp(absl::string_view path, const CommandFacts& command);

}  // namespace latvox

#endif  // LATVOX_MANUAL_HELP_H_
