// What the tool says of itself, beside its options.
#ifndef LATVOX_CLIENT_TOOL_CLI_PAGES_H_
#define LATVOX_CLIENT_TOOL_CLI_PAGES_H_

#include <string>

#include "deploy/manual/command_facts.h"

namespace latvox::client {

// For `latvox` alone: what it does, and examples to run as they stand.
std::string Introduction();

// Behind the options of `latvox --help`, and of a command.
std::string Footer();
std::string FooterOf(const std::string& command);

// The page latvox(1) in troff's language.
std::string ManPageOf(CommandFacts facts);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PAGES_H_
