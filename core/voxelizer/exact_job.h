// A job that finds voxels exactly: of a surface, a supercover or a solid, or a band with its distances.
#ifndef LATVOX_CORE_VOXELIZER_EXACT_JOB_H_
#define LATVOX_CORE_VOXELIZER_EXACT_JOB_H_

#include <memory>
#include <optional>
#include <vector>

#include "core/attributes/plan.h"
#include "core/band/band_scan.h"
#include "core/base/stop_signal.h"
#include "core/lattice/frame.h"
#include "core/snap/snap.h"
#include "core/supercover/supercover.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"

namespace latvox {

// Digitizes tile by tile, a pipeline of units of some tiles each.
//   supercover, band, attributes   null, and nullopt, where options do not ask for them
//   region                         local voxels to deliver, within mesh.box
//   bounds                         of these, deliver only the ones within
// Memory: the mesh, the edges that its tiny triangles cross, and the tiles in flight; of a solid with force_open, also
// all crossings of lines along k.
std::unique_ptr<VoxelizeJob> MakeExactJob(SnappedMesh mesh, const std::vector<Frame>& frames,
                                          std::unique_ptr<const Supercover> supercover,
                                          const std::optional<BandPlan>& band,
                                          std::optional<CarriedAttributes> attributes, const VoxelizeOptions& options,
                                          const IndexBox& region, const std::optional<WorldBox>& bounds,
                                          StopSignal stop);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_EXACT_JOB_H_
