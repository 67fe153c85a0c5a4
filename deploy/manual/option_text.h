// Texts about options that help, man pages and the Markdown reference share.
#ifndef LATVOX_MANUAL_OPTION_TEXT_H_
#define LATVOX_MANUAL_OPTION_TEXT_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "deploy/manual/command_facts.h"

namespace latvox {

// Returns the text with its first letter in upper case.
std::string Capital(absl::string_view text);

// Returns the description with its range, default and whether it is required: "Pixels (16 to 8192; default: 800)".
std::string DescriptionOf(const OptionFacts& option);

// Returns the words of a call: the path of the command, its arguments, required options, "[OPTIONS]".
//   path   "latvox slice"
std::vector<std::string> UsageOf(absl::string_view path, const CommandFacts& command);

// Returns the options by group, in the order in which the groups first appear. A group of --help alone comes last.
std::vector<std::pair<std::string, std::vector<OptionFacts>>> GroupsOf(const CommandFacts& command);

// Returns the words in lines of at most `width` characters. A longer word has its own line.
std::vector<std::string> Wrap(const std::vector<std::string>& words, size_t width);

}  // namespace latvox

#endif  // LATVOX_MANUAL_OPTION_TEXT_H_
