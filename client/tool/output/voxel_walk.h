// The voxels of a brick.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_WALK_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_WALK_H_

#include <bit>

#include "latvox/types.h"

namespace latvox::client {

// Calls visit(ijk) for every voxel of the brick, in lexicographic order of ijk.
template <class Visit>
void ForEachVoxel(const Brick& brick, const Visit& visit) {
  const Vec3i corner = {brick.brick_ijk[0] * 8, brick.brick_ijk[1] * 8, brick.brick_ijk[2] * 8};
  for (int x = 0; x < 8; ++x) {
    for (uint64_t bits = brick.mask[static_cast<size_t>(x)]; bits != 0; bits &= bits - 1) {
      const int yz = std::countr_zero(bits);
      visit(Vec3i{corner[0] + x, corner[1] + (yz >> 3), corner[2] + (yz & 7)});
    }
  }
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_WALK_H_
