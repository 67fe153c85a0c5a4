// A block of tiles from its triangles: scan, thin, cut out.
#ifndef LATVOX_CORE_BLOCK_TILE_JOB_H_
#define LATVOX_CORE_BLOCK_TILE_JOB_H_

#include <vector>

#include "core/block/link_ends.h"
#include "core/block/solid_tiles.h"
#include "core/block/surface_scan.h"
#include "core/block/thinner.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/lattice/frame.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// The longest step of the frames, per axis.
Vec3i ReachOf(const std::vector<Frame>& frames);

// A thread's memory for one block, reused for the next.
struct BlockScan {
  SurfaceScan surface;
  Thinner thinner;
  SolidTiles solid;
  LinkEnds links;
  int far_blocks = 0;  // in sequence, that were thinned with the whole halo; only speed depends on it

  size_t Bytes() const { return surface.Bytes() + thinner.Bytes() + solid.Bytes() + links.Bytes(); }
};

// Finds the surface's voxels in the node and its overlap, as scan.surface.voxels().
void FindSurface(const TileContext& context, const TileNode& node, BlockScan& scan);

// Appends the node's tiles that have voxels, in global coordinates and in the canonical order. Once the job is
// cancelled, the tiles are incomplete.
//   node       of a tree with the context's margins
//   interior   null, or that of the mesh
//   surface    whether to include the surface's voxels
void DigitizeBlock(const TileContext& context, const TileNode& node, const Interior* interior, bool surface,
                   BlockScan& scan, std::vector<TileBricks>& tiles);

// Appends the node's tiles that have ends of crossed links, in the same way.
//   interior   that of the mesh; null if both sides are wanted
void FindLinksOfBlock(const TileContext& context, const TileNode& node, const Interior* interior, LinkSide side,
                      BlockScan& scan, std::vector<TileBricks>& tiles);

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_TILE_JOB_H_
