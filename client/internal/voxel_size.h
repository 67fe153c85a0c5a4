// The size of a lattice's voxels. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_VOXEL_SIZE_H_
#define LATVOX_CLIENT_INTERNAL_VOXEL_SIZE_H_

#include <cmath>

#include "latvox/types.h"

namespace latvox::client {

// Returns the cube root of the volume of a cell. The root of a double is often one unit in the last place wrong. That
// of a long double, rounded once more, seldom is.
inline double VoxelSizeOf(const Basis& basis) {
  const auto& [a, b, c] = basis;
  const double volume =
      a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  return static_cast<double>(std::cbrt(std::abs(static_cast<long double>(volume))));
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_VOXEL_SIZE_H_
