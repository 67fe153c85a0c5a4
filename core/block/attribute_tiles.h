// The attributes of a job's tiles.
#ifndef LATVOX_CORE_BLOCK_ATTRIBUTE_TILES_H_
#define LATVOX_CORE_BLOCK_ATTRIBUTE_TILES_H_

#include <cstdint>
#include <optional>
#include <span>

#include "core/attributes/attribute_scan.h"
#include "core/attributes/plan.h"
#include "core/base/stop_signal.h"
#include "core/block/scan_pool.h"
#include "core/brick/brick.h"
#include "core/snap/snap.h"

namespace latvox {

// Threads: Add, any thread.
class AttributeTiles {
 public:
  //   carried   nullopt: the job has no attributes
  // The other two must outlive it.
  AttributeTiles(const SnappedMesh& mesh, std::optional<CarriedAttributes> carried, StopSignal stop);

  // Finds the attributes of the tiles, which lie in a node with these triangles.
  void Add(std::span<const uint32_t> triangles, std::span<TileBricks> tiles) const;

 private:
  const std::optional<AttributeContext> context_;
  mutable ScanPool<AttributeScan> scans_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_ATTRIBUTE_TILES_H_
