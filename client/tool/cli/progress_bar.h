// Progress, for people.
#ifndef LATVOX_CLIENT_TOOL_CLI_PROGRESS_BAR_H_
#define LATVOX_CLIENT_TOOL_CLI_PROGRESS_BAR_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace latvox::client {

// "1234 bricks, 617/s", without the rate while the time is too short to tell.
std::string CountText(const char* what, uint64_t count, absl::Duration elapsed);

// ", 12s left", at a constant rate; nothing while that cannot be told.
std::string RemainingText(double share, absl::Duration elapsed);

// "12.3K": three digits or so, whole below ten thousand.
std::string ShortNumber(uint64_t count);

// What fits into a line of so many columns, one of them left free.
struct ProgressLine {
  size_t cells;      // of the bar, between brackets
  std::string text;  // behind it
};

// " 45 %  voxelizing: 1234567 bricks, 2345678/s, 12s left". Where there is less room, the bar shrinks first, then the
// counts: " 45 %  voxelizing: 12s left, 1.2M bricks, 2.3M/s"; what still does not fit is cut off at the end.
ProgressLine FitProgress(size_t columns, double share, const std::string& stage, const char* what, uint64_t count,
                         absl::Duration elapsed);

// A line on standard error if that is a terminal, else nothing at all. It is gone with its object.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // What is being done from now on, shown at once. The time that remains is of the stage that Show is of.
  void Stage(const std::string& name);

  // `share` of the stage is done, 0 to 1, and so many of `what`. Draws ten times a second at most.
  void Show(double share, const char* what, uint64_t count);

  // The same with `text` behind the bar.
  void Show(double share, const std::string& text);

  // A line on standard error, whatever that is, in the bar's place.
  void Say(const std::string& line);

 private:
  bool Due();
  static void Draw(double share, const ProgressLine& line);

  const bool terminal_;
  std::string stage_;
  absl::Time start_ = absl::Now();
  absl::Time next_ = absl::InfinitePast();
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PROGRESS_BAR_H_
