// A block of tiles from its triangles: scan, thin, cut out.
#ifndef LATVOX_CORE_VOXELIZER_TILE_JOB_H_
#define LATVOX_CORE_VOXELIZER_TILE_JOB_H_

#include <vector>

#include "core/lattice/frame.h"
#include "core/tile/brick.h"
#include "core/tile/tile_tree.h"
#include "core/voxelizer/tile_scan.h"

namespace latvox {

// Per axis, the longest step of the frames.
Vec3i ReachOf(const std::vector<Frame>& frames);

// Appends the node's tiles that have voxels, in global coordinates and in the canonical order; once the job is
// cancelled, whatever there is.
//   node   of a tree with the context's margins
//   scan   a thread's own, from block to block
void DigitizeBlock(const TileContext& context, const TileNode& node, TileScan& scan, std::vector<TileBricks>& tiles);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_TILE_JOB_H_
