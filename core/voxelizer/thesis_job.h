// A job that runs one of the thesis's algorithms.
#ifndef LATVOX_CORE_VOXELIZER_THESIS_JOB_H_
#define LATVOX_CORE_VOXELIZER_THESIS_JOB_H_

#include <memory>
#include <optional>

#include "core/base/stop_signal.h"
#include "core/snap/snap.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"

namespace latvox {

// Computes the whole set at the first Advance, then delivers it like any other job, in canonical order. Verify checks
// the voxels against the snapped mesh, so tunnels that come from rounding vertices to lattice points count.
//   region   local voxels to deliver, within mesh.box
//   bounds   deliver only voxels of `region` within these
// Memory: the whole set. Precondition: request.algorithm() is not kExact.
std::unique_ptr<VoxelizeJob> MakeThesisJob(SnappedMesh mesh, const Lattice& lattice, const VoxelRequest& request,
                                           const IndexBox& region, const std::optional<WorldBox>& bounds,
                                           StopSignal creation);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_THESIS_JOB_H_
