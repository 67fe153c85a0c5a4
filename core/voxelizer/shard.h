// The part of a job's tiles that it delivers. Splits a whole into parts of about the same cost.
#ifndef LATVOX_CORE_VOXELIZER_SHARD_H_
#define LATVOX_CORE_VOXELIZER_SHARD_H_

#include <optional>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/brick/tile_order.h"
#include "core/lattice/frame.h"
#include "core/snap/snap.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"

namespace latvox {

// Returns the tiles that part.shard and part.resume_after leave.
//
// The spans of all shards of one count follow each other in the canonical order, and leave nothing out, whatever the
// mesh: the union of the parts is the whole. They depend on the arguments alone, and are computed in integers. So every
// worker finds the same split without asking the others.
//
// An estimate makes the split fair: a triangle costs its voxels, and a constant in each tile that it meets. The split
// is as fine as tiles are, or, with more than 128 tiles along an axis, as a 128th of the longest side. Memory: 16 MiB.
//   frames   of the request's separability
//   region   local voxels; tiles outside cost nothing
//   bounds   tiles outside cost nothing
//   stop     once stopped, the function returns soon with a meaningless result
// Precondition: that of VoxelizeJob::Create.
TileSpan SpanOf(const Part& part, const SnappedMesh& mesh, const std::vector<Frame>& frames, const IndexBox& region,
                const std::optional<WorldBox>& bounds, StopSignal stop);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_SHARD_H_
