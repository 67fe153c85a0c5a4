// Progress for people.
#ifndef LATVOX_CLIENT_TOOL_CLI_PROGRESS_BAR_H_
#define LATVOX_CLIENT_TOOL_CLI_PROGRESS_BAR_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace latvox::client {

// Returns "1234 bricks, 617/s". The rate is missing while the time is too short for one.
std::string CountText(const char* what, uint64_t count, absl::Duration elapsed);

// Returns ", 12s left", assuming a constant rate; "" while the rate is unknown.
std::string RemainingText(double share, absl::Duration elapsed);

// Returns "12.3K": about three digits, and whole numbers below ten thousand.
std::string ShortNumber(uint64_t count);

// A progress line that fits into a given number of columns and leaves one free.
struct ProgressLine {
  size_t cells;      // length of the bar between its brackets
  std::string text;  // after the bar
};

// Returns " 45 %  voxelizing: 1234567 bricks, 2345678/s, 12s left". With less room the bar shrinks first. Then the
// counts become short: " 45 %  voxelizing: 12s left, 1.2M bricks, 2.3M/s". Then texts are left out: the counts, the
// stage and the time left, the bar.
ProgressLine FitProgress(size_t columns, double share, const std::string& stage, const char* what, uint64_t count,
                         absl::Duration elapsed);

// Shows a line on standard error if that is a terminal and HideProgress was not called. The destructor removes the
// line.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Begins a stage and shows its name at once. The time left counts from the stage that calls Show.
  void Stage(const std::string& name);

  // Shows that `share` of the stage is done, 0 to 1, and the count of `what`. Draws ten times a second at most.
  void Show(double share, const char* what, uint64_t count);

  // Shows the share with `text` after the bar.
  void Show(double share, const std::string& text);

  // Prints a line on standard error, terminal or not, in place of the bar.
  void Say(const std::string& line);

 private:
  bool Due();
  static void Draw(double share, const ProgressLine& line);

  const bool terminal_;
  std::string stage_;
  absl::Time start_ = absl::Now();
  absl::Time next_ = absl::InfinitePast();
};

// Bars that are made from now on show nothing but what Say prints. It is for --quiet.
void HideProgress();

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PROGRESS_BAR_H_
