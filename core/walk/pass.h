// A pass over all tiles around a mesh: large cubes far from it as a whole, and blocks of tiles near it with their
// walls.
#ifndef LATVOX_CORE_WALK_PASS_H_
#define LATVOX_CORE_WALK_PASS_H_

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/cpu_meter.h"
#include "core/block/scan_pool.h"
#include "core/block/tile_context.h"
#include "core/tree/tile_tree.h"
#include "core/walk/plan.h"
#include "core/walk/tile_pieces.h"
#include "core/walk/walls.h"

namespace latvox {

// The memory of one thread.
struct WalkScan {
  WallScan walls;
  PieceScan pieces;
  std::vector<WideRow> rows;
  TileRows reached;
  TileBits bits{BitsLayout({}, {}).Words()};  // of a delivered tile

  // Returns the bricks of a tile with these points, as BlockVoxels::CutOut does.
  TileBricks CutOut(const TileContext& context, const Vec3i& tile_ijk, const TileRows& points);
};

class WalkPass {
 public:
  //   context   with the overlap of the plan's steps
  //   tree      with margins for the context and the plan; it keeps empty nodes
  //   scans     the memory of its threads; the pass of another label may go on with it
  // All must outlive it.
  WalkPass(const TileContext& context, const WalkPlan& plan, const TileTree& tree, ScanPool<WalkScan>& scans)
      : context_(context), plan_(plan), tree_(tree), scans_(scans) {}

  // Calls far(tile_ijk, level) for cubes without walls in them and their overlap, and near(tile_ijk, scan) for each
  // other tile, with the walls of its block. Together they are all tiles of the tree, each once. Any thread may call,
  // in any order.
  //   kept   the triangles that matter, ascending; nullopt: all
  template <class Far, class Near>
  void Run(std::optional<std::vector<uint32_t>> kept, const Far& far, const Near& near) {
    VisitAll(tree_.Top(std::move(kept)), far, near);
  }

 private:
  template <class Far, class Near>
  void VisitAll(std::vector<TileNode> nodes, const Far& far, const Near& near) {
    oneapi::tbb::parallel_for(
        oneapi::tbb::blocked_range<size_t>(0, nodes.size(), 1),
        [&](const auto& some) {
          for (size_t n = some.begin(); n < some.end(); ++n) Visit(nodes[n], far, near);
        },
        oneapi::tbb::simple_partitioner());
  }

  template <class Far, class Near>
  void Visit(const TileNode& node, const Far& far, const Near& near) {
    if (context_.stop.Stopped()) return;
    if (node.triangles.empty() && !HasLinksNear(node)) return far(node.tile_ijk, node.level);
    if (!tree_.IsLeaf(node)) return VisitAll(ChildrenOf(node), far, near);
    const CpuMeter::Scope scope(meter_);
    std::unique_ptr<WalkScan> scan = scans_.Reserve();
    scan->walls.Scan(context_, plan_.close ? &*plan_.close : nullptr, node);
    for (int32_t n = 0; n < 1 << 3 * node.level && !context_.stop.Stopped(); ++n) {
      near(node.tile_ijk + Vec3i{n >> 2 & 1, n >> 1 & 1, n & 1}, *scan);
    }
    if (!context_.stop.Stopped()) scans_.Release(std::move(scan));
  }

  std::vector<TileNode> ChildrenOf(const TileNode& node) const {
    const CpuMeter::Scope scope(meter_);
    return tree_.Children(node);
  }

  // Whether the node or a node of its size beside it has links. A node's overlap reaches no farther.
  bool HasLinksNear(const TileNode& node) const;

  const TileContext& context_;
  const WalkPlan& plan_;
  const TileTree& tree_;
  ScanPool<WalkScan>& scans_;
  CpuMeter* const meter_ = CpuMeter::OfThread();  // counts for all threads
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_PASS_H_
