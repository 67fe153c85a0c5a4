// The canonical order of tiles.
#ifndef LATVOX_CORE_TILE_TILE_ORDER_H_
#define LATVOX_CORE_TILE_TILE_ORDER_H_

#include <cstdint>

#include "core/base/vec.h"

namespace latvox {

// Whether tile a comes before tile b in Morton order, i the most significant axis, of coordinates relative to `low`,
// which must not be negative. The axis whose highest differing bit is highest decides; of several, the first.
inline bool ComesBefore(const Vec3i& a, const Vec3i& b, const Vec3i& low) {
  size_t axis = 0;
  uint32_t decisive = 0;
  for (size_t m = 0; m < 3; ++m) {
    const uint32_t difference = static_cast<uint32_t>(a[m] - low[m]) ^ static_cast<uint32_t>(b[m] - low[m]);
    if (decisive < difference && decisive < (decisive ^ difference)) {
      axis = m;
      decisive = difference;
    }
  }
  return a[axis] < b[axis];
}

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_TILE_ORDER_H_
