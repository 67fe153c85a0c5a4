// One tile from its triangles: scan, thin, cut out.
#ifndef LATVOX_CORE_VOXELIZER_TILE_JOB_H_
#define LATVOX_CORE_VOXELIZER_TILE_JOB_H_

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/lattice/frame.h"
#include "core/snap/snap.h"
#include "core/tile/brick.h"

namespace latvox {

// What all tiles of a job have in common.
struct TileContext {
  const SnappedMesh& mesh;
  const std::vector<Frame>& frames;
  Vec3i reach;      // per axis, the largest |q| of the frames
  bool minimal;     // whether to thin
  IndexBox region;  // local voxels outside are not delivered
  const std::atomic<bool>& cancelled;

  // How far, per axis, triangles may lie outside of a tile and still matter to it, in voxels.
  Vec3i Margin() const;
};

// Per axis, the longest step of the frames.
Vec3i ReachOf(const std::vector<Frame>& frames);

// The voxels of the tile, in global coordinates, or nullopt if there are none or the job was cancelled.
//   tile_ijk    local
//   triangles   all that come within Margin() of the tile; more do no harm
std::optional<TileBricks> DigitizeTile(const TileContext& context, const Vec3i& tile_ijk,
                                       const std::vector<uint32_t>& triangles);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_TILE_JOB_H_
