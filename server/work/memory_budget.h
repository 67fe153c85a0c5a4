// The budget of memory for all jobs together.
#ifndef LATVOX_SERVER_WORK_MEMORY_BUDGET_H_
#define LATVOX_SERVER_WORK_MEMORY_BUDGET_H_

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

#include "absl/status/status.h"

namespace latvox {

// Thread-safe, and cheap enough for gRPC's callbacks. Must outlive its reservations.
class MemoryBudget {
 public:
  explicit MemoryBudget(uint64_t bytes) : total_(bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  uint64_t total() const { return total_; }
  uint64_t reserved() const { return reserved_; }

 private:
  friend class MemoryReservation;

  bool Reserve(uint64_t bytes);

  const uint64_t total_;
  std::atomic<uint64_t> reserved_ = 0;
};

// A job's share. Threads: one at a time.
class MemoryReservation {
 public:
  explicit MemoryReservation(MemoryBudget& budget) : budget_(&budget) {}
  ~MemoryReservation() { Shrink(0); }
  MemoryReservation(MemoryReservation&& other) noexcept
      : budget_(other.budget_), bytes_(std::exchange(other.bytes_, 0)) {}
  MemoryReservation& operator=(MemoryReservation&&) = delete;

  // Raises the reservation to `bytes` in all, if it is less. Errors: RESOURCE_EXHAUSTED, without a retry delay if that
  // exceeds the whole budget, and with one if other jobs have it.
  absl::Status Grow(uint64_t bytes);

  // Gives back all above `bytes`.
  void Shrink(uint64_t bytes);

  uint64_t bytes() const { return bytes_; }

 private:
  MemoryBudget* budget_;
  uint64_t bytes_ = 0;
};

// Three quarters of the memory of the machine, or of the process's control groups if these have less.
uint64_t DefaultMemoryBudget();

// The budget of a server whose parent needs memory as well: half of that, but no less than a server needs to start, as
// far as it exists.
inline constexpr uint64_t kLeastMemoryBudget = uint64_t{256} << 20;
constexpr uint64_t SharedMemoryBudget(uint64_t budget) {
  return std::min(budget, std::max(budget / 2, kLeastMemoryBudget));
}

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_MEMORY_BUDGET_H_
