// Abilities of standard error.
#ifndef LATVOX_CLIENT_TOOL_CLI_TERMINAL_H_
#define LATVOX_CLIENT_TOOL_CLI_TERMINAL_H_

#include <cstddef>
#include <string>

#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns whether standard error is a terminal that can redraw a line: TERM is not "dumb".
bool ErrorIsTerminal();

// Returns the columns of the terminal, or 80.
size_t ErrorColumns();

enum class TerminalColor { kRed = 31, kGreen = 32 };

// Returns the text in that color if standard error is such a terminal and NO_COLOR is absent or empty. Otherwise
// returns the text.
std::string Colored(absl::string_view text, TerminalColor color);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_TERMINAL_H_
