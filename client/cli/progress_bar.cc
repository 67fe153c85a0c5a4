#include "client/cli/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/terminal.h"

namespace latvox::client {
namespace {

constexpr size_t kCells = 30;
constexpr absl::Duration kTelling = absl::Milliseconds(500);  // a rate of less than that says nothing

}  // namespace

std::string CountText(const char* what, uint64_t count, absl::Duration elapsed) {
  std::string text = absl::StrCat(count, " ", what);
  if (elapsed < kTelling) return text;
  return absl::StrCat(text, ", ", std::llround(static_cast<double>(count) / absl::ToDoubleSeconds(elapsed)), "/s");
}

std::string RemainingText(double share, absl::Duration elapsed) {
  constexpr double kLeast = 0.01;
  if (elapsed < kTelling || share < kLeast) return "";
  const absl::Duration left = elapsed * ((1 - std::min(share, 1.0)) / share);
  return absl::StrCat(", ", absl::FormatDuration(absl::Ceil(left, absl::Seconds(1))), " left");
}

ProgressBar::ProgressBar() : terminal_(ErrorIsTerminal()) {}

ProgressBar::~ProgressBar() {
  if (terminal_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::Say(const std::string& line) {
  std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\x1b[K" : "", line.c_str());
  next_ = absl::InfinitePast();
}

void ProgressBar::Stage(const std::string& name) {
  stage_ = name;
  start_ = absl::Now();
  next_ = absl::InfinitePast();
  if (terminal_) Draw("", name);
}

void ProgressBar::Show(double share, const std::string& text) {
  constexpr absl::Duration kInterval = absl::Milliseconds(100);
  if (!terminal_ || absl::Now() < next_) return;
  next_ = absl::Now() + kInterval;
  const size_t full = static_cast<size_t>(std::clamp(share, 0.0, 1.0) * kCells);
  const std::string bar = Coloured(std::string(full, '#'), Colour::kGreen) + std::string(kCells - full, '.');
  std::string words = absl::StrFormat(" %3.0f %%  ", share * 100);
  if (!stage_.empty()) absl::StrAppend(&words, stage_, ": ");
  absl::StrAppend(&words, text);
  if (!stage_.empty()) words += RemainingText(share, elapsed());
  Draw(absl::StrCat("[", bar, "]"), words);
}

// In one line: what does not fit would stay behind when the next is drawn over it.
void ProgressBar::Draw(const std::string& bar, std::string text) {
  const size_t taken = bar.empty() ? 1 : kCells + 3, columns = ErrorColumns();
  text.resize(std::min(text.size(), columns > taken ? columns - taken : 0));
  std::fprintf(stderr, "\r%s%s\x1b[K", bar.c_str(), text.c_str());
  std::fflush(stderr);
}

}  // namespace latvox::client
