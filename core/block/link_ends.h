// The ends of all links of a block that the mesh crosses.
#ifndef LATVOX_CORE_BLOCK_LINK_ENDS_H_
#define LATVOX_CORE_BLOCK_LINK_ENDS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block/block_voxels.h"
#include "core/block/candidate_parts.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/request/links.h"
#include "core/tile/voxel_triangle.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// Links along principal directions come first. Their ends are nearly all ends. So a star is found only where it may
// have another one (core/scan/open_stars.h).
//
// Reuses the memory of one node for the next. Leaves part of the work undone once the job is cancelled.
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
  void AddStars(const TileContext& context);

  BlockVoxels voxels_;
  CandidateParts candidates_;
  std::vector<VoxelTriangle> pairs_;  // whose stars may have another end
  std::vector<uint32_t> others_;      // the triangles that are not tiny
};

// Removes the voxels of a tile that are not on this side.
//   inside   rows of the tile, as InteriorRows::view
void KeepSide(LinkSide side, std::span<const uint64_t> inside, TileBricks& tile);

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_LINK_ENDS_H_
