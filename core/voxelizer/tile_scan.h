// The voxels of a box from the triangles around it, and the crossed edges that thinning asks for.
#ifndef LATVOX_CORE_VOXELIZER_TILE_SCAN_H_
#define LATVOX_CORE_VOXELIZER_TILE_SCAN_H_

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/thin/thin.h"
#include "core/tile/brick.h"
#include "core/tile/tile_box.h"

namespace latvox {

// What all tiles of a job have in common.
struct TileContext {
  const SnappedMesh& mesh;
  const std::vector<ScanFrame>& frames;
  Vec3i reach;      // per axis, the largest |q| of the frames
  bool minimal;     // whether to thin
  IndexBox region;  // local voxels outside are not delivered
  const std::atomic<bool>& cancelled;

  // How far, per axis, triangles may lie outside of a tile and still matter to it, in voxels.
  Vec3i Margin() const;
};

// Adds to `set` all voxels of the surface in `box`: the nearer ends of all crossed edges. If the job is to be thinned,
// adds some of these edges to `edges`, one of each voxel at least, except where the other end lies outside of the box.
//   triangles   all that come within half a step of the box; more do no harm
// Returns early, with part of it, once the job is cancelled.
void ScanBox(const TileContext& context, const std::vector<uint32_t>& triangles, const IndexBox& box, TileBox& set,
             std::vector<CrossedEdge>& edges);

// Takes out of `rest`, a part of `set`, the voxels that a crossed edge shows essential, and returns all crossed edges
// at those that stay.
//   set, triangles   as ScanBox leaves and takes them
//   rest             a step inside of `box`, or more
std::vector<CrossedEdge> EdgesAtRest(const TileContext& context, const std::vector<uint32_t>& triangles,
                                     const IndexBox& box, const TileBox& set, TileBox& rest);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_TILE_SCAN_H_
