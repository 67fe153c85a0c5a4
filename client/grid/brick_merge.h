// Several parts as one sequence of bricks. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_BRICK_MERGE_H_
#define LATVOX_CLIENT_GRID_BRICK_MERGE_H_

#include <functional>
#include <memory>
#include <queue>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "client/grid/part_file.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The union of all parts' bricks, in the tree's order, again after each Rewind. Memory: that of the parts. Not
// thread-safe.
class BrickMerge {
 public:
  using Parts = std::vector<std::unique_ptr<PartFile>>;

  // `disjoint`: a brick in two parts is an error. `progress` gets two numbers from time to time: how often the parts
  // have been read, such as 1.5 times, and the bricks read in all passes.
  BrickMerge(Parts parts, bool disjoint, const Cancellation& cancellation,
             std::function<void(double, uint64_t)> progress);

  // Goes back to the place before the first brick.
  void Rewind();

  // Returns the next brick; null at the end, and on an error. Valid until the next call.
  const Brick* Next();

  // The bricks of the parts that have been read since the last Rewind.
  uint64_t read() const { return read_ - read_before_; }

  // The first error: of a part (see PartFile); INVALID_ARGUMENT (a brick in two parts); CANCELLED.
  const absl::Status& status() const { return status_; }

 private:
  struct Head {
    TreePlace place;
    size_t part;
    auto operator<=>(const Head&) const = default;
  };

  void Advance(size_t part);
  void Tick();

  Parts parts_;
  const bool disjoint_;
  const Cancellation cancellation_;
  const std::function<void(double, uint64_t)> progress_;
  std::vector<const Brick*> bricks_;  // the next one of each part; null: none is left
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads_;
  uint64_t read_ = 0, read_before_ = 0;  // bricks, in all passes; in those before this one
  uint64_t passes_ = 0;                  // that have begun
  Brick brick_{};
  absl::Status status_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_BRICK_MERGE_H_
