// Boxes around the voxels that each of many triangles may contribute. They find the triangles of a few voxels.
#ifndef LATVOX_CORE_SCAN_TRIANGLE_BOXES_H_
#define LATVOX_CORE_SCAN_TRIANGLE_BOXES_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/uninitialized.h"
#include "core/scan/stars.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// A bound takes one byte, so that a vector compares many triangles with a voxel.
class TriangleBoxes {
 public:
  static constexpr int32_t kMostSide = 256;  // voxels; of the box that contains all of them
  static constexpr size_t kSlack = 64;       // at most a vector

  size_t size() const { return size_; }
  size_t Bytes() const { return bounds_.size() * BytesOf(bounds_[0]); }
  void Clear() { size_ = 0; }
  void Reserve(size_t more) {
    for (auto& bounds : bounds_) bounds.resize(std::max(bounds.size(), size_ + more + kSlack));
  }
  // Kernels write whole vectors there, and then set the count: the lowest and the highest voxels of an axis, from the
  // low corner of the box that contains all.
  uint8_t* Lowest(size_t axis) { return bounds_[axis].data() + size_; }
  uint8_t* Highest(size_t axis) { return bounds_[3 + axis].data() + size_; }
  void Grow(size_t by) { size_ += by; }

  // Replaces `pairs` by each of the voxels with all triangles whose boxes contain it, and returns true, if there are no
  // more than `most` pairs. Otherwise returns false soon, with meaningless pairs.
  //   low         corner of the box that contains all boxes
  //   triangles   their numbers
  //   voxels      within that box
  bool FindPairs(const BitsLayout& layout, const Vec3i& low, std::span<const uint32_t> triangles,
                 std::span<const uint32_t> voxels, size_t most, std::vector<VoxelTriangle>& pairs) const;

 private:
  size_t size_ = 0;
  std::array<UninitializedVector<uint8_t>, 6> bounds_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_SCAN_TRIANGLE_BOXES_H_
