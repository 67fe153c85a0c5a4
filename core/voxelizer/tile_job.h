// One tile from its triangles: scan, thin, cut out.
#ifndef LATVOX_CORE_VOXELIZER_TILE_JOB_H_
#define LATVOX_CORE_VOXELIZER_TILE_JOB_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/lattice/frame.h"
#include "core/tile/brick.h"
#include "core/voxelizer/tile_scan.h"

namespace latvox {

// Per axis, the longest step of the frames.
Vec3i ReachOf(const std::vector<Frame>& frames);

// The voxels of the tile, in global coordinates, or nullopt if there are none or the job was cancelled.
//   tile_ijk    local
//   triangles   all that come within context.NearMargin() of the tile; more do no harm
//   fringe      the others that come within context.FarMargin()
//   scan        a thread's own, from tile to tile
std::optional<TileBricks> DigitizeTile(const TileContext& context, const Vec3i& tile_ijk,
                                       const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& fringe,
                                       TileScan& scan);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_TILE_JOB_H_
