// The fields of a job's tiles that come from the nearest triangle.
#ifndef LATVOX_CORE_BLOCK_FIELD_TILES_H_
#define LATVOX_CORE_BLOCK_FIELD_TILES_H_

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/stop_signal.h"
#include "core/block/scan_pool.h"
#include "core/brick/brick.h"
#include "core/fields/field_scan.h"
#include "core/fields/plan.h"
#include "core/fields/triangle_index.h"
#include "core/snap/snap.h"
#include "core/solid/interior.h"

namespace latvox {

// Threads: Add, any thread.
class FieldTiles {
 public:
  //   plan    null: the job has no fields
  //   index   as FieldContext::index
  // All must outlive it.
  FieldTiles(const SnappedMesh& mesh, const FieldPlan* plan, const TriangleIndex* index, StopSignal stop);

  // Finds the fields of the tiles, which lie in a node with these triangles.
  //   interior   null, or that which decides on signs
  void Add(std::span<const uint32_t> triangles, const Interior* interior, std::span<TileBricks> tiles) const;

 private:
  const std::optional<FieldContext> context_;
  mutable ScanPool<FieldScan> scans_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_FIELD_TILES_H_
