// Digitizes units of parallel work.
#ifndef LATVOX_CORE_VOXELIZER_UNIT_SCAN_H_
#define LATVOX_CORE_VOXELIZER_UNIT_SCAN_H_

#include <memory>
#include <optional>
#include <vector>

#include "core/band/band_scan.h"
#include "core/base/stop_signal.h"
#include "core/block/field_tiles.h"
#include "core/block/fraction_tiles.h"
#include "core/block/link_tiles.h"
#include "core/block/scan_pool.h"
#include "core/block/tile_context.h"
#include "core/block/tile_job.h"
#include "core/brick/brick.h"
#include "core/solid/interior.h"
#include "core/tree/tile_tree.h"
#include "core/voxelizer/exact_plan.h"
#include "core/voxelizer/labeled_walk.h"
#include "core/voxelizer/unit_scheduler.h"
#include "core/walk/walk.h"

namespace latvox {

// What a job prepares before its first tile. Null: the job does not need it.
struct Prepared {
  std::unique_ptr<const Interior> interior;         // of a solid, or that which decides on sides
  std::unique_ptr<const Interior> finer;            // for a fraction: the same for the finer mesh
  std::unique_ptr<const Walk> walk;                 // for a set that a walk decides
  std::unique_ptr<const LabeledWalk> labeled_walk;  // for a labeled one
};

// Threads: Scan, any thread.
class UnitScan {
 public:
  //   plan   must outlive it, as must `units`
  //   stop   while stopped, tiles are missing
  UnitScan(const ExactPlan& plan, const UnitScheduler& units, StopSignal stop);

  // Returns the unit's tiles that are delivered, in canonical order, in global coordinates.
  std::vector<TileBricks> Scan(const TileNode& unit, const Prepared& prepared) const;

  // Leaves the memory of blocks to later jobs. Precondition: no Scan runs.
  void LeaveMemory() const { scans_.Leave(); }

 private:
  void Process(const TileNode& node, const Prepared& prepared, std::vector<TileBricks>& out) const;
  void ScanLeaf(const TileNode& node, const Prepared& prepared, std::vector<TileBricks>& out) const;

  const ExactPlan& plan_;
  const UnitScheduler& units_;
  const TileContext context_;
  const FieldTiles fields_;
  const LinkTiles links_;
  const FractionTiles fractions_;
  const std::optional<BandContext> band_;
  mutable ScanPool<BlockScan> scans_;
  mutable ScanPool<BandScan> band_scans_;
  mutable ScanPool<WalkScan> walk_scans_;
  mutable ScanPool<LabeledWalkScan> labeled_walk_scans_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_UNIT_SCAN_H_
