#include "server/work/memory_budget.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "deploy/process/exhaustion.h"
#include "server/base/control_group.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

constexpr absl::Duration kRetryDelay = absl::Seconds(1), kConsideration = absl::Seconds(10);

}  // namespace

uint64_t MemoryBudget::reserved() const {
  const std::lock_guard lock(mu_);
  return reserved_;
}

bool MemoryBudget::WasShort() {
  const std::lock_guard lock(mu_);
  return std::exchange(was_short_, false);
}

std::optional<MemoryBudget::Obstacle> MemoryBudget::Reserve(const std::string& client, uint64_t bytes) {
  const std::lock_guard lock(mu_);
  const auto found = of_clients_.find(client);
  const uint64_t has = found == of_clients_.end() ? 0 : found->second;
  const bool in_the_way = has > 0 && refused_ != client && absl::Now() - refused_at_ < kConsideration;
  const bool fits = bytes <= total_ - reserved_;
  if (fits && !(in_the_way && has + bytes > total_ / 2)) {
    reserved_ += bytes;
    of_clients_[client] += bytes;
    return std::nullopt;
  }
  was_short_ = true;
  if (fits) return Obstacle{has, total_ / 2};
  refused_ = client;
  refused_at_ = absl::Now();
  return Obstacle{reserved_, total_};
}

void MemoryBudget::Release(const std::string& client, uint64_t bytes) {
  const std::lock_guard lock(mu_);
  reserved_ -= bytes;
  const auto found = of_clients_.find(client);
  found->second -= bytes;
  if (found->second == 0) of_clients_.erase(found);
}

absl::Status MemoryReservation::Grow(uint64_t bytes) {
  if (bytes <= bytes_) return absl::OkStatus();
  if (bytes > budget_->total()) return LimitExceeded("memory", bytes, budget_->total());
  if (const auto obstacle = budget_->Reserve(client_, bytes - bytes_)) {
    const bool is_share = obstacle->limit < budget_->total();
    const std::string message = absl::StrCat(
        "memory: ", bytes, " bytes are needed, and ", is_share ? "other jobs of this client have " : "others have ",
        obstacle->reserved - bytes_, " of ", is_share ? "its share of " : "", obstacle->limit, "; try again");
    return WithRetry(MakeError(absl::StatusCode::kResourceExhausted, message,
                               {"MEMORY_IN_USE", "memory", absl::StrCat(bytes), absl::StrCat(budget_->total()),
                                "memory_budget_bytes"}),
                     kRetryDelay);
  }
  bytes_ = bytes;
  most_bytes_ = std::max(most_bytes_, bytes);
  return absl::OkStatus();
}

void MemoryReservation::Shrink(uint64_t bytes) {
  if (bytes >= bytes_) return;
  budget_->Release(client_, bytes_ - bytes);
  bytes_ = bytes;
}

uint64_t DefaultMemoryBudget() {
  const uint64_t machine =
      static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  return std::min({machine, LimitsOfControlGroups().memory_bytes, AddressLimit()}) / 4 * 3;
}

}  // namespace latvox
