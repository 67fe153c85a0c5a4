// A snapped mesh for a finer lattice.
#ifndef LATVOX_CORE_SNAP_FINER_MESH_H_
#define LATVOX_CORE_SNAP_FINER_MESH_H_

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/snap/snap.h"

namespace latvox {

// The mesh in the coordinates of the lattice that is n times as fine. All vertices are multiplied by n, so nothing is
// rounded again, and the lattice point z is the finer point `origin` + n z. Both are local.
struct FinerMesh {
  SnappedMesh mesh;
  Vec3i origin;
};

// Shares the triangles of the mesh. Once cancelled, the result is meaningless.
//   offset   `origin` is the sum of this and a multiple of kTileSide on each axis
// Errors: RESOURCE_EXHAUSTED, naming fraction_n, if the finer extent along an axis exceeds kMaxExtent.
absl::StatusOr<FinerMesh> MakeFinerMesh(const SnappedMesh& mesh, int32_t n, const Vec3i& offset, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_FINER_MESH_H_
