// A sparse set of voxels.
#ifndef LATVOX_CORE_BRICK_VOXEL_SET_H_
#define LATVOX_CORE_BRICK_VOXEL_SET_H_

#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/base/stop_signal.h"
#include "core/brick/brick.h"

namespace latvox {

// Answers membership. Memory: about 90 bytes for each brick with a voxel.
class VoxelSet {
 public:
  void Add(const Brick& brick);
  void Add(const VoxelSet& other, StopSignal stop = {});
  void Insert(const Vec3i& ijk);

  bool Contains(const Vec3i& ijk) const { return Find(ijk).has_value(); }
  uint64_t size() const { return size_; }

  // Returns a number below 64 * words() that belongs to this voxel alone, or nullopt if it is not in the set.
  std::optional<uint64_t> Find(const Vec3i& ijk) const;
  size_t words() const { return masks_.size() * std::tuple_size_v<BrickMask>; }

  // Returns all bricks, in lexicographic order of brick_ijk, whatever the order of their addition.
  std::vector<Brick> Bricks(StopSignal stop = {}) const;

 private:
  BrickMask& MaskOf(const Vec3i& brick_ijk);

  absl::flat_hash_map<Vec3i, uint32_t> index_;  // of brick_ijk into masks_
  std::vector<BrickMask> masks_;
  uint64_t size_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_VOXEL_SET_H_
