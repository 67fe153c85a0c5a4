// Counts tunnels and redundant voxels of a finished voxel set.
//
// A link is a segment z -> z+q between k-neighbors.
#ifndef LATVOX_CORE_VERIFY_VERIFY_H_
#define LATVOX_CORE_VERIFY_VERIFY_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/brick/voxel_set.h"
#include "core/lattice/lattice.h"
#include "core/snap/snap.h"

namespace latvox {

struct Verdict {
  uint64_t tunnels = 0;    // crossed links without an end in the set
  uint64_t redundant = 0;  // voxels that could leave, one at a time, without a tunnel
};

// Scans the whole mesh in every direction, triangle by triangle, and checks each crossed link against `voxels`. Errors:
// CANCELLED once stopped.
absl::StatusOr<Verdict> CountTunnels(const SnappedMesh& mesh, const std::vector<Frame>& frames, const VoxelSet& voxels,
                                     StopSignal stop);

}  // namespace latvox

#endif  // LATVOX_CORE_VERIFY_VERIFY_H_
