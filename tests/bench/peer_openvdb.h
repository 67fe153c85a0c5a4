// OpenVDB's meshToVolume, to be timed beside ours.
#ifndef LATVOX_TESTS_BENCH_PEER_OPENVDB_H_
#define LATVOX_TESTS_BENCH_PEER_OPENVDB_H_

#include <cstdint>

#include "core/mesh/mesh.h"

namespace latvox {

// The mesh in OpenVDB's own containers and in index space (Cartesian, voxel size 1, low corner of `bounds` at 0): what
// its caller would have at hand, so that conversion is not timed.
class OpenVdbPeer {
 public:
  OpenVdbPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size);
  ~OpenVdbPeer();
  OpenVdbPeer(const OpenVdbPeer&) = delete;
  OpenVdbPeer& operator=(const OpenVdbPeer&) = delete;

  // An unsigned distance field with a band of so many voxels on both sides; returns its active voxels.
  uint64_t Run(float band) const;

 private:
  struct Data;
  Data* data_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PEER_OPENVDB_H_
