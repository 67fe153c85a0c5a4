// What each host may cause, over all its connections.
#ifndef LATVOX_SERVER_GUARD_HOST_BUDGETS_H_
#define LATVOX_SERVER_GUARD_HOST_BUDGETS_H_

#include <sys/socket.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "absl/time/time.h"
#include "server/guard/work_budget.h"

namespace latvox {

// Returns the bytes of the host that counts: an IPv4 address, or the first 64 bits of an IPv6 address, because the
// client chooses the others. Empty for Unix sockets.
std::string HostKey(const sockaddr_storage& address);

// Thread-safe.
class HostBudget {
 public:
  // `per_second`: for frames. New connections have half of that, in larger bursts, because clients start together.
  HostBudget(Work per_second, absl::Time now)
      : arrivals_(per_second / 2, per_second, now), frames_(per_second, per_second / kFrameBurstsInASecond, now) {}

  // Each returns whether the budget covers the work.
  bool SpendOnArrival(Work work, absl::Time now) {
    const std::lock_guard lock(mu_);
    return arrivals_.Spend(work, now);
  }
  bool SpendOnFrames(Work work, absl::Time now) {
    const std::lock_guard lock(mu_);
    return frames_.Spend(work, now);
  }

  bool Full(absl::Time now) {
    const std::lock_guard lock(mu_);
    return arrivals_.Full(now) && frames_.Full(now);
  }

 private:
  // gRPC works in the order of arrival, so calls of others wait for a whole burst.
  static constexpr Work kFrameBurstsInASecond = 16;

  std::mutex mu_;
  WorkBudget arrivals_, frames_;  // guarded by mu_
};

// Thread-safe. It forgets a host that has no connection, once its budget is full again.
class HostBudgets {
 public:
  explicit HostBudgets(Work per_second) : per_second_(per_second) {}

  // Returns the budget of a host. How many share it, besides this object, is its number of connections.
  std::shared_ptr<HostBudget> Of(const std::string& host, absl::Time now);

  size_t size() const {
    const std::lock_guard lock(mu_);
    return hosts_.size();
  }

 private:
  const Work per_second_;
  mutable std::mutex mu_;
  std::unordered_map<std::string, std::shared_ptr<HostBudget>> hosts_;  // guarded by mu_
  size_t forget_at_ = 64;                                               // guarded by mu_; the size that asks for a look
};

}  // namespace latvox

#endif  // LATVOX_SERVER_GUARD_HOST_BUDGETS_H_
