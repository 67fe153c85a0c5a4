// Progress, for people.
#ifndef LATVOX_CLIENT_CLI_PROGRESS_BAR_H_
#define LATVOX_CLIENT_CLI_PROGRESS_BAR_H_

#include <cstdint>
#include <string>

#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace latvox::client {

// "1234 bricks, 617/s", without the rate while the time is too short to tell.
std::string CountText(const char* what, uint64_t count, absl::Duration elapsed);

// ", 12s left", at a constant rate; nothing while that cannot be told.
std::string RemainingText(double share, absl::Duration elapsed);

// A line on standard error if that is a terminal, else nothing at all. It is gone with its object.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // What is being done from now on, shown at once. The time that remains is of the stage that Show is of.
  void Stage(const std::string& name);

  // `share` of the stage is done, 0 to 1; `text` stands behind it. Draws ten times a second at most.
  void Show(double share, const std::string& text);

  // A line on standard error, whatever that is, in the bar's place.
  void Say(const std::string& line);

  absl::Duration elapsed() const { return absl::Now() - start_; }  // in this stage

 private:
  void Draw(const std::string& bar, std::string text);

  const bool terminal_;
  std::string stage_;
  absl::Time start_ = absl::Now();
  absl::Time next_ = absl::InfinitePast();
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLI_PROGRESS_BAR_H_
