// Other programs' voxelizers, timed beside our core.
#ifndef LATVOX_TESTS_BENCH_PEER_H_
#define LATVOX_TESTS_BENCH_PEER_H_

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/mesh/mesh.h"

namespace latvox {

// A mesh in the containers of another program. A caller of it would have the mesh there, so the conversion is not
// timed.
class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  // Finds the voxels: the timed work.
  virtual absl::Status Run() = 0;
  // Returns the number of voxels of the last run, and frees them.
  virtual uint64_t Finish() = 0;
};

// OpenVDB's meshToVolume: an unsigned distance field with a band of `half_width` voxels on both sides. Its voxels are
// the active ones. The lattice is Cartesian, with the low corner of `bounds` at 0.
std::unique_ptr<Peer> OpenVdbPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size, float half_width);

// Recast's rcRasterizeTriangles: spans of a heightfield whose cells are as large as voxels. The spans' cells are its
// voxels. Columns run along the mesh's shortest side. Errors: INVALID_ARGUMENT for more cells along it than a span can
// have; UNIMPLEMENTED if Recast was not there when latvox was configured.
absl::StatusOr<std::unique_ptr<Peer>> RecastPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PEER_H_
