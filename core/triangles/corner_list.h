// The corners of a list of triangles, side by side, in 16 bits a number. Kernels that read them again need not go back
// to the mesh.
#ifndef LATVOX_CORE_TRIANGLES_CORNER_LIST_H_
#define LATVOX_CORE_TRIANGLES_CORNER_LIST_H_

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/lattice/frame.h"
#include "core/snap/snap.h"

namespace latvox {

// Corners are in lattice units from the low corner of the first corner's voxel. A triangle is near if all of them are
// within -kNear .. kNear - 1 on each axis; the numbers of other triangles are clamped. Whole vectors can be read; the
// numbers behind the list are meaningless.
struct CornerList {
  static constexpr size_t kMost = 1024, kSlack = 64;  // small beside a core's second-level cache
  static constexpr int16_t kNear = 16 * kLatticeUnit;
  // The number for the origin's voxel, and the number of voxels per axis from the one before it on.
  static constexpr int32_t kFirstVoxel = INT16_MIN + 1, kVoxels = 1 << 16;

  using Row = std::array<int16_t, 8>;  // three numbers twice, each with a meaningless one behind

  size_t size = 0;
  uint32_t triangles[kMost + kSlack];               // their numbers
  alignas(64) Row first_two[kMost + kSlack];        // corners
  alignas(64) Row third_and_voxel[kMost + kSlack];  // third corner; voxel of the first corner, counted from the origin

  // Sets the corners at a place.
  //   origin   local voxel. The first corner's voxel has a number if it is one of kVoxels per axis, from the one before
  //            the origin on; else its number is meaningless
  void SetCorners(size_t place, const std::array<Vec3i, 3>& v, const Vec3i& origin);

  bool IsNear(size_t place) const;
  Vec3i Corner(size_t n, size_t place) const {
    const int16_t* const of = n < 2 ? &first_two[place][4 * n] : third_and_voxel[place].data();
    return {of[0], of[1], of[2]};
  }

  // Appends the triangle at a place >= size, which was in the list before `size` was reduced. So some are left out.
  void Keep(size_t place) {
    triangles[size] = triangles[place];
    first_two[size] = first_two[place];
    third_and_voxel[size] = third_and_voxel[place];
    ++size;
  }
};
static_assert(std::has_single_bit(CornerList::kMost) && CornerList::kMost < 1 << 15,
              "places are masked, and fit 16 bits");
static_assert(std::has_single_bit(static_cast<uint16_t>(CornerList::kNear)));
static_assert(kMaxFrameRow * CornerList::kNear < 1 << 15, "rows of frames have values of 16 bits at near corners");

}  // namespace latvox

#endif  // LATVOX_CORE_TRIANGLES_CORNER_LIST_H_
