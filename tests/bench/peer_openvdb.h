// OpenVDB's meshToVolume, timed beside our core.
#ifndef LATVOX_TESTS_BENCH_PEER_OPENVDB_H_
#define LATVOX_TESTS_BENCH_PEER_OPENVDB_H_

#include <cstdint>

#include "core/mesh/mesh.h"

namespace latvox {

// The mesh in OpenVDB's own containers and in index space (Cartesian, voxel size 1, low corner of `bounds` at 0). A
// caller of OpenVDB would have it in this form, so the conversion is not timed.
class OpenVdbPeer {
 public:
  OpenVdbPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size);
  ~OpenVdbPeer();
  OpenVdbPeer(const OpenVdbPeer&) = delete;
  OpenVdbPeer& operator=(const OpenVdbPeer&) = delete;

  // Makes an unsigned distance field with a band of `half_width` voxels on both sides, and returns its active voxels.
  uint64_t Run(float band) const;

 private:
  struct Data;
  Data* data_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PEER_OPENVDB_H_
