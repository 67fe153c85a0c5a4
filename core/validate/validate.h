// Counts tunnels and redundant voxels of a finished voxel set.
#ifndef LATVOX_CORE_VALIDATE_VALIDATE_H_
#define LATVOX_CORE_VALIDATE_VALIDATE_H_

#include <atomic>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "core/lattice/lattice.h"
#include "core/snap/snap.h"
#include "core/tile/brick.h"

namespace latvox {

// A sparse voxel set that answers membership.
class VoxelSet {
 public:
  void Add(const Brick& brick);
  bool Contains(const Vec3i& ijk) const { return Find(ijk).has_value(); }
  uint64_t size() const { return size_; }

  // A number below 64 * words() that is the voxel's alone, or nullopt if it is not in the set.
  std::optional<uint64_t> Find(const Vec3i& ijk) const;
  size_t words() const { return masks_.size() * std::tuple_size_v<BrickMask>; }

 private:
  absl::flat_hash_map<Vec3i, uint32_t> index_;  // of brick_ijk into masks_
  std::vector<BrickMask> masks_;
  uint64_t size_ = 0;
};

struct Verdict {
  uint64_t tunnels = 0;    // crossed lattice edges without an end in the set
  uint64_t redundant = 0;  // voxels that could leave, one at a time, without a tunnel
};

// Scans the whole mesh in every direction, triangle by triangle, and holds each crossed edge against `voxels`.
// Errors: CANCELLED once *cancelled is true.
absl::StatusOr<Verdict> Validate(const SnappedMesh& mesh, const std::vector<Frame>& frames, const VoxelSet& voxels,
                                 const std::atomic<bool>& cancelled);

}  // namespace latvox

#endif  // LATVOX_CORE_VALIDATE_VALIDATE_H_
