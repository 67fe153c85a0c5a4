// The budget of memory for all jobs together, and each client's share of it.
#ifndef LATVOX_SERVER_WORK_MEMORY_BUDGET_H_
#define LATVOX_SERVER_WORK_MEMORY_BUDGET_H_

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace latvox {

// A client may have the whole budget until the server refuses another client. For ten seconds after that, the jobs of
// one client may not grow beyond half of the budget together. So memory that it gives back is there for others.
//
// Thread-safe, and cheap enough for gRPC's callbacks. Must outlive its reservations.
class MemoryBudget {
 public:
  explicit MemoryBudget(uint64_t bytes) : total_(bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  uint64_t total() const { return total_; }
  uint64_t reserved() const;

  // Returns whether a reservation was refused since the last call, although the budget has so much.
  bool WasShort();

 private:
  friend class MemoryReservation;

  struct Obstacle {
    uint64_t reserved = 0, limit = 0;  // of all clients and the budget, or of this client and its share
  };

  // Returns what stands in the way; nothing: it is reserved.
  std::optional<Obstacle> Reserve(const std::string& client, uint64_t bytes);
  void Release(const std::string& client, uint64_t bytes);

  const uint64_t total_;
  mutable std::mutex mu_;
  // All below is guarded by mu_.
  uint64_t reserved_ = 0;
  std::unordered_map<std::string, uint64_t> of_clients_;  // those that have some
  std::string refused_;                                   // the last client that was refused
  absl::Time refused_at_ = absl::InfinitePast();
  bool was_short_ = false;
};

// A job's share. Threads: one at a time.
class MemoryReservation {
 public:
  //   client   that the job counts for
  explicit MemoryReservation(MemoryBudget& budget, std::string client = "")
      : budget_(&budget), client_(std::move(client)) {}
  ~MemoryReservation() { Shrink(0); }
  MemoryReservation(MemoryReservation&& other) noexcept
      : budget_(other.budget_), client_(other.client_), bytes_(std::exchange(other.bytes_, 0)) {}
  MemoryReservation& operator=(MemoryReservation&&) = delete;

  // Raises the reservation to `bytes` in all, if it is less. Errors: RESOURCE_EXHAUSTED, without a retry delay if that
  // exceeds the whole budget, and with one if other jobs have it, or the client has its share.
  absl::Status Grow(uint64_t bytes);

  // Gives back all above `bytes`.
  void Shrink(uint64_t bytes);

  uint64_t bytes() const { return bytes_; }
  uint64_t most_bytes() const { return most_bytes_; }  // at any time so far

 private:
  MemoryBudget* budget_;
  std::string client_;
  uint64_t bytes_ = 0, most_bytes_ = 0;
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
