// What the tool says of itself, beside its options.
#ifndef LATVOX_CLIENT_TOOL_CLI_PAGES_H_
#define LATVOX_CLIENT_TOOL_CLI_PAGES_H_

#include <CLI/App.hpp>
#include <string>

namespace latvox::client {

// For `latvox` alone: what it does, and examples to run as they stand.
std::string Introduction();

// Behind the options of `latvox --help`, and of each command.
std::string Footer();
void AddFooters(CLI::App& app);

// The page latvox(1) in troff's language.
std::string ManPageOf(const CLI::App& app);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PAGES_H_
