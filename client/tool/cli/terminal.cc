#include "client/tool/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

#include "absl/strings/str_cat.h"

namespace latvox::client {

bool ErrorIsTerminal() {
  const char* const term = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && (term == nullptr || absl::string_view(term) != "dumb");
}

size_t ErrorColumns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string Colored(absl::string_view text, TerminalColor color) {
  const char* const no_color = std::getenv("NO_COLOR");
  if (text.empty() || !ErrorIsTerminal() || (no_color != nullptr && *no_color != '\0')) return std::string(text);
  return absl::StrCat("\x1b[", static_cast<int>(color), "m", text, "\x1b[0m");
}

}  // namespace latvox::client
