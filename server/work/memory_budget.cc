#include "server/work/memory_budget.h"

#include <unistd.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "deploy/process/exhaustion.h"
#include "server/base/control_group.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

constexpr absl::Duration kRetryDelay = absl::Seconds(1);

}  // namespace

bool MemoryBudget::Reserve(uint64_t bytes) {
  uint64_t reserved = reserved_;
  do {
    if (bytes > total_ - reserved) return false;
  } while (!reserved_.compare_exchange_weak(reserved, reserved + bytes));
  return true;
}

absl::Status MemoryReservation::Grow(uint64_t bytes) {
  if (bytes <= bytes_) return absl::OkStatus();
  if (bytes > budget_->total()) return LimitExceeded("memory", bytes, budget_->total());
  if (!budget_->Reserve(bytes - bytes_)) {
    const std::string message = absl::StrCat("memory: ", bytes, " bytes are needed, and others have ",
                                             budget_->reserved() - bytes_, " of ", budget_->total(), "; try again");
    return WithRetry(MakeError(absl::StatusCode::kResourceExhausted, message,
                               {"MEMORY_IN_USE", "memory", absl::StrCat(bytes), absl::StrCat(budget_->total()),
                                "memory_budget_bytes"}),
                     kRetryDelay);
  }
  bytes_ = bytes;
  return absl::OkStatus();
}

void MemoryReservation::Shrink(uint64_t bytes) {
  if (bytes >= bytes_) return;
  budget_->reserved_ -= bytes_ - bytes;
  bytes_ = bytes;
}

uint64_t DefaultMemoryBudget() {
  const uint64_t machine =
      static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  return std::min({machine, LimitsOfControlGroups().memory_bytes, AddressLimit()}) / 4 * 3;
}

}  // namespace latvox
