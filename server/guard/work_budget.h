// The work that a peer may cause, as a budget that refills with time.
#ifndef LATVOX_SERVER_GUARD_WORK_BUDGET_H_
#define LATVOX_SERVER_GUARD_WORK_BUDGET_H_

#include <algorithm>
#include <cstdint>

#include "absl/time/time.h"

namespace latvox {

// Work in nanoseconds of one core, roughly: what gRPC needs for a frame.
using Work = int64_t;

// A budget that begins full. Not thread-safe.
class WorkBudget {
 public:
  // `per_second` refills, up to `most`.
  WorkBudget(Work per_second, Work most, absl::Time now)
      : per_second_(per_second), most_(most), left_(most), filled_(now) {}

  // Returns whether the budget covers the work, and takes it from the budget if so.
  bool Spend(Work work, absl::Time now) {
    Refill(now);
    if (left_ < work) return false;
    left_ -= work;
    return true;
  }

  // Returns whether the budget is as good as new.
  bool Full(absl::Time now) {
    Refill(now);
    return left_ == most_;
  }

 private:
  // Time that is too short for one unit stays for the next call.
  void Refill(absl::Time now) {
    const absl::Duration passed = std::min(now - filled_, absl::Seconds(most_ / per_second_ + 1));
    const Work more = static_cast<Work>(absl::ToDoubleSeconds(passed) * static_cast<double>(per_second_));
    if (more <= 0) return;
    left_ = std::min(most_, left_ + more);
    filled_ = now;
  }

  Work per_second_, most_, left_;
  absl::Time filled_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_GUARD_WORK_BUDGET_H_
