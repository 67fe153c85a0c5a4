// Rows of bits, grown by a ball.
#ifndef LATVOX_CORE_WALK_GROWTH_H_
#define LATVOX_CORE_WALK_GROWTH_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/band/plan.h"
#include "core/base/stop_signal.h"
#include "core/walk/tile_rows.h"

namespace latvox {

// All lattice vectors within a length, as runs along k.
class Ball {
 public:
  // The memory of the largest one, with a run of 16 bytes for each row.
  static constexpr uint64_t kMostRows = 2 * kMostPlannedReach + 1, kMostBytes = 16 * kMostRows * kMostRows;

  // Once stopped, it is meaningless.
  explicit Ball(const BandPlan& length, StopSignal stop = {});

  // Adds to a tile's rows all points that a vector of the ball leads to from a member of the set.
  //   set   the members in a tile around, by its position relative to this one; null: none
  // Returns soon once stopped, with a meaningless result.
  void Grow(const std::function<const TileRows*(const Vec3i& beside)>& set, StopSignal stop, TileRows& rows) const;

  // Per axis, voxels.
  const Vec3i& reach() const { return reach_; }

 private:
  struct Run {
    int32_t di, dj, low, high;  // the vectors (di, dj, low .. high)
  };

  static Run RunAlong(const BandPlan& length, int32_t i, int32_t j);
  void Add(const Run& run);

  Vec3i reach_;
  std::vector<Run> runs_;  // short ones first
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_GROWTH_H_
