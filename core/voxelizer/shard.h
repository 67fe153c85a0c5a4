// The part of a job's tiles that it delivers, and the split of a whole into parts that cost about the same.
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

// The tiles that part.shard and part.resume_after leave.
//
// The spans of all shards of a count follow each other in the canonical order and leave nothing out, whatever the mesh:
// the parts' union is the whole. They are computed from the arguments alone, in integers, so that every worker finds
// the same split without asking the others.
//
// The split is fair by an estimate: a triangle costs its voxels and a constant in each tile that it meets. It
// is as fine as tiles are, or, where these are more than 128 along an axis, a 128th of the longest side. Memory: 16
// MiB.
//   frames      of the request's separability
//   region      local voxels: tiles outside cost nothing
//   bounds      nor does what is outside of these
//   stop        once stopped, the result comes soon, and means nothing
// Precondition: as VoxelizeJob::Create checks.
TileSpan SpanOf(const Part& part, const SnappedMesh& mesh, const std::vector<Frame>& frames, const IndexBox& region,
                const std::optional<WorldBox>& bounds, StopSignal stop);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_SHARD_H_
