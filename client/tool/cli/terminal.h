// What standard error can show.
#ifndef LATVOX_CLIENT_TOOL_CLI_TERMINAL_H_
#define LATVOX_CLIENT_TOOL_CLI_TERMINAL_H_

#include <cstddef>
#include <string>

#include "absl/strings/string_view.h"

namespace latvox::client {

// Whether standard error is a terminal that can go back in a line: TERM is not "dumb".
bool ErrorIsTerminal();

// Its columns, or 80.
size_t ErrorColumns();

enum class Colour { kRed = 31, kGreen = 32 };

// The text in that colour, if standard error is such a terminal, and NO_COLOR is absent or empty; else the text.
std::string Coloured(absl::string_view text, Colour colour);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_TERMINAL_H_
