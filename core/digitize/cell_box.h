// The box of cells around a triangle, where cells are boxes along the lattice axes.
#ifndef LATVOX_CORE_DIGITIZE_CELL_BOX_H_
#define LATVOX_CORE_DIGITIZE_CELL_BOX_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/brick/brick.h"
#include "core/digitize/crossing.h"

namespace latvox {

// Returns the voxels whose cells meet the triangle's bounding box.
inline IndexBox BoxOfCells(const Triangle& triangle) {
  constexpr int32_t kHalf = kLatticeUnit / 2;
  const auto& [a, b, c] = triangle;
  IndexBox box;
  for (size_t m = 0; m < 3; ++m) {
    const int32_t low = std::min(a[m], std::min(b[m], c[m])), high = std::max(a[m], std::max(b[m], c[m]));
    box.min[m] = (low + kHalf - 1) >> kSubvoxelBits;
    box.max[m] = ((high + kHalf) >> kSubvoxelBits) + 1;
  }
  return box;
}

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_CELL_BOX_H_
