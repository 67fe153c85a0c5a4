// The ends of all links of a block that the mesh crosses.
#ifndef LATVOX_CORE_BLOCK_LINK_ENDS_H_
#define LATVOX_CORE_BLOCK_LINK_ENDS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block/block_voxels.h"
#include "core/block/link_scan.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/request/links.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// Reuses the memory of one node for the next.
class LinkEnds {
 public:
  // Finds the ends in the node, and some outside of it. Links of tiny triangles come from the context.
  //   node   its triangles are all that come within a step of it; more do no harm
  void Find(const TileContext& context, const TileNode& node);

  // The ends that were found last.
  BlockVoxels& voxels() { return voxels_; }

  // Bytes of memory.
  size_t Bytes() const;

 private:
  LinkScan scan_;
  BlockVoxels voxels_;
  std::vector<uint32_t> others_;  // the triangles that are not tiny
};

// Removes the voxels of a tile that are not on this side.
//   inside   rows of the tile, as InteriorRows::view
void KeepSide(LinkSide side, std::span<const uint64_t> inside, TileBricks& tile);

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_LINK_ENDS_H_
