// Divides the tree of tiles into units of parallel work.
#ifndef LATVOX_CORE_VOXELIZER_UNIT_SCHEDULER_H_
#define LATVOX_CORE_VOXELIZER_UNIT_SCHEDULER_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/brick/filled_tiles.h"
#include "core/tree/tile_tree.h"
#include "core/voxelizer/exact_plan.h"

namespace latvox {

// Returns units in the canonical order of their tiles. The units are disjoint subtrees, and each subtree is either a
// unit, left out as a whole, or replaced by its children in order. So every tile of the part comes once, whatever the
// number of threads. The number of threads decides which tiles form a unit, but not their voxels: see ExactPlan.
//
// Threads: Next, PutBack, AddFilled and DropTriangles, one at a time; the rest, any thread.
class UnitScheduler {
 public:
  //   plan   must outlive it
  //   kept   moved from the plan, so that its memory is free once the tree's top is known
  //   job    once stopped, there are no further units
  UnitScheduler(const ExactPlan& plan, std::optional<std::vector<uint32_t>> kept, StopSignal job);

  // Also visits tiles without triangles nearby, from now on, if they may hold points of the set. Call it before Next.
  // `filled` must outlive this object.
  void AddFilled(const FilledTiles& filled);

  // From now on, nodes list no triangles. Call it after AddFilled and before Next.
  void DropTriangles() { kept_ = std::vector<uint32_t>(); }

  // The next unit; nullopt if none is left.
  std::optional<TileNode> Next();
  // Puts the last units that Next has returned back, in their order.
  void PutBack(std::vector<TileNode> units);
  bool Done() const { return started_ && todo_.empty(); }  // an interruption may come before the first Next

  // Whether none of a node's tiles is delivered.
  bool IsLeftOut(const TileNode& node) const;
  // Whether a tile in global coordinates is within the part that is delivered.
  bool IsInSpan(const Vec3i& tile_ijk) const { return plan_.span.Contains(NumberOf(tile_ijk)); }

  const TileTree& tree() const { return tree_; }

  // A copy of the triangles that tiles need to know, before Next.
  const std::optional<std::vector<uint32_t>>& kept() const { return kept_; }

 private:
  bool IsUnit(const TileNode& node) const;
  uint64_t NumberOf(const Vec3i& tile_ijk) const;
  void SplitNext();

  const ExactPlan& plan_;
  const StopSignal job_;
  const Vec3i tile_base_;
  TileTree tree_;
  std::optional<std::vector<uint32_t>> kept_;
  const FilledTiles* filled_ = nullptr;
  bool started_ = false;
  std::vector<TileNode> todo_;  // once started: the rest of the tree, the next node last
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_UNIT_SCHEDULER_H_
