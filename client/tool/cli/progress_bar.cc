#include "client/tool/cli/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "client/tool/cli/terminal.h"

namespace latvox::client {
namespace {

constexpr size_t kMostCells = 30, kGoodCells = 10, kLeastCells = 4;
constexpr absl::Duration kTelling = absl::Milliseconds(500);  // a shorter time gives no useful rate

double RateOf(uint64_t count, absl::Duration elapsed) {
  return static_cast<double>(count) / absl::ToDoubleSeconds(elapsed);
}

// Returns the columns that a text of this length leaves for the bar.
size_t Room(size_t columns, size_t taken) {
  constexpr size_t kBesides = 3;  // two brackets and the free column
  return columns > taken + kBesides ? columns - taken - kBesides : 0;
}

ProgressLine Fit(size_t columns, const std::string& text) {
  return {std::min(Room(columns, text.size()), kMostCells), text.substr(0, Room(columns, 0))};
}

}  // namespace

std::string CountText(const char* what, uint64_t count, absl::Duration elapsed) {
  std::string text = absl::StrCat(count, " ", what);
  if (elapsed < kTelling) return text;
  return absl::StrCat(text, ", ", std::llround(RateOf(count, elapsed)), "/s");
}

std::string RemainingText(double share, absl::Duration elapsed) {
  constexpr double kLeast = 0.01;
  if (elapsed < kTelling || share < kLeast) return "";
  const absl::Duration left = elapsed * ((1 - std::min(share, 1.0)) / share);
  return absl::StrCat(", ", absl::FormatDuration(absl::Ceil(left, absl::Seconds(1))), " left");
}

std::string ShortNumber(uint64_t count) {
  if (count < 10000) return absl::StrCat(count);
  double number = static_cast<double>(count);
  size_t unit = 0;
  for (; number >= 999.5 && unit < 4; ++unit) number /= 1000;
  return absl::StrFormat("%.3g%c", number < 10 ? std::round(number * 10) / 10 : number, " KMGT"[unit]);
}

ProgressLine FitProgress(size_t columns, double share, const std::string& stage, const char* what, uint64_t count,
                         absl::Duration elapsed) {
  const std::string head = absl::StrFormat(" %3.0f %%  %s: ", share * 100, stage);
  const std::string left = RemainingText(share, elapsed);
  const std::string bricks = absl::StrCat(ShortNumber(count), " ", what);
  const std::string rate =
      elapsed < kTelling
          ? ""
          : absl::StrCat(", ", ShortNumber(static_cast<uint64_t>(std::llround(RateOf(count, elapsed)))), "/s");
  const absl::string_view time = absl::StripPrefix(left, ", ");
  const std::string texts[] = {absl::StrCat(head, CountText(what, count, elapsed), left),
                               absl::StrCat(head, time, time.empty() ? "" : ", ", bricks, rate),
                               absl::StrCat(head, time.empty() ? absl::string_view(bricks) : time),
                               absl::StrFormat(" %3.0f %%", share * 100)};
  size_t least = kGoodCells;
  for (const std::string& text : texts) {
    if (Room(columns, text.size()) >= least) return Fit(columns, text);
    least = kLeastCells;
  }
  return Fit(columns, *std::rbegin(texts));
}

namespace {

bool hidden = false;

}  // namespace

void HideProgress() { hidden = true; }

ProgressBar::ProgressBar() : terminal_(ErrorIsTerminal() && !hidden) {}

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
  if (!terminal_) return;
  // Stays within one line: redrawing would not erase a second one.
  const size_t columns = ErrorColumns();
  std::fprintf(stderr, "\r%s\x1b[K", name.substr(0, columns > 1 ? columns - 1 : 0).c_str());
  std::fflush(stderr);
}

void ProgressBar::Show(double share, const char* what, uint64_t count) {
  if (Due()) Draw(share, FitProgress(ErrorColumns(), share, stage_, what, count, absl::Now() - start_));
}

void ProgressBar::Show(double share, const std::string& text) {
  if (Due()) Draw(share, Fit(ErrorColumns(), absl::StrFormat(" %3.0f %%  %s", share * 100, text)));
}

bool ProgressBar::Due() {
  constexpr absl::Duration kInterval = absl::Milliseconds(100);
  if (!terminal_ || absl::Now() < next_) return false;
  next_ = absl::Now() + kInterval;
  return true;
}

void ProgressBar::Draw(double share, const ProgressLine& line) {
  const size_t full = static_cast<size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(line.cells));
  const std::string bar = Colored(std::string(full, '#'), TerminalColor::kGreen) + std::string(line.cells - full, '.');
  std::fprintf(stderr, "\r[%s]%s\x1b[K", bar.c_str(), line.text.c_str());
  std::fflush(stderr);
}

}  // namespace latvox::client
