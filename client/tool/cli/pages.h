// Texts of help and manual, beside the options.
#ifndef LATVOX_CLIENT_TOOL_CLI_PAGES_H_
#define LATVOX_CLIENT_TOOL_CLI_PAGES_H_

#include <string>

#include "deploy/manual/command_facts.h"

namespace latvox::client {

// Returns the text of `latvox` without a command: its purpose, and examples that run as they are.
std::string Introduction();

// Return the text after the options of `latvox --help`, and of a command's help.
std::string Footer();
std::string FooterOf(const std::string& command);

// Returns the page latvox(1) in troff.
std::string ManPageOf(CommandFacts facts);

// Returns the page client/docs/command-line.md.
std::string ReferenceOf(const CommandFacts& facts);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PAGES_H_
