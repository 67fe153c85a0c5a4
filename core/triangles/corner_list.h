// The corners of a list of triangles, side by side, in 16 bits a number: kernels that come back to them need not look
// at the mesh again.
#ifndef LATVOX_CORE_TRIANGLES_CORNER_LIST_H_
#define LATVOX_CORE_TRIANGLES_CORNER_LIST_H_

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/lattice/frame.h"
#include "core/snap/snap.h"

namespace latvox {

// Corners are in lattice units from the low corner of the first one's voxel. A triangle is near if all of them are
// within -kNear .. kNear - 1 on each axis; of others, numbers are those next to the true ones that fit. Whole vectors
// can be read; what lies behind the list means nothing.
struct CornerList {
  static constexpr size_t kMost = 1024, kSlack = 64;  // small beside a core's second-level cache
  static constexpr int16_t kNear = 16 * kLatticeUnit;
  // What stands for the origin's voxel, and how many there are from the one before it on, per axis.
  static constexpr int32_t kFirstVoxel = INT16_MIN + 1, kVoxels = 1 << 16;

  using Row = std::array<int16_t, 8>;  // twice three numbers, each with one behind that means nothing

  size_t size = 0;
  uint32_t triangles[kMost + kSlack];               // their numbers
  alignas(64) Row first_two[kMost + kSlack];        // corners
  alignas(64) Row third_and_voxel[kMost + kSlack];  // third corner; voxel of the first one, from the origin

  // Sets the corners at a place.
  //   origin   local voxel: the first corner's is one of kVoxels from that before it on, per axis, else the voxel
  //            means nothing
  void SetCorners(size_t place, const std::array<Vec3i, 3>& v, const Vec3i& origin);

  bool IsNear(size_t place) const;
  Vec3i Corner(size_t n, size_t place) const {
    const int16_t* const of = n < 2 ? &first_two[place][4 * n] : third_and_voxel[place].data();
    return {of[0], of[1], of[2]};
  }

  // Appends the triangle at a place >= size, which was in the list before `size` was set back: so some are left out.
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
