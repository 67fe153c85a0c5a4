// Progress, for people.
#ifndef LATVOX_CLIENT_CLI_PROGRESS_BAR_H_
#define LATVOX_CLIENT_CLI_PROGRESS_BAR_H_

#include <string>

#include "absl/time/time.h"

namespace latvox::client {

// A bar on standard error if that is a terminal, else nothing at all. It is gone with its object.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // `share` of the work is done, 0 to 1; `text` stands behind it. Draws ten times a second at most.
  void Show(double share, const std::string& text);

  // A line on standard error, whatever that is, in the bar's place.
  void Say(const std::string& line);

 private:
  const bool terminal_;
  absl::Time next_ = absl::InfinitePast();
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLI_PROGRESS_BAR_H_
