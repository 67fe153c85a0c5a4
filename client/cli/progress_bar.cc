#include "client/cli/progress_bar.h"

#include <unistd.h>

#include <cstdio>

#include "absl/time/clock.h"

namespace latvox::client {

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::Say(const std::string& line) {
  std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\x1b[K" : "", line.c_str());
  next_ = absl::InfinitePast();
}

void ProgressBar::Show(double share, const std::string& text) {
  constexpr size_t kCells = 30;
  constexpr absl::Duration kInterval = absl::Milliseconds(100);
  if (!terminal_ || absl::Now() < next_) return;
  next_ = absl::Now() + kInterval;
  const size_t full = static_cast<size_t>(share * kCells);
  const std::string bar = std::string(full, '#') + std::string(kCells - full, '.');
  std::fprintf(stderr, "\r[%s] %3.0f %%  %s\x1b[K", bar.c_str(), share * 100, text.c_str());
}

}  // namespace latvox::client
