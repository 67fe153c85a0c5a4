// Where a set may fill tiles that the surface does not come near.
#ifndef LATVOX_CORE_BRICK_FILLED_TILES_H_
#define LATVOX_CORE_BRICK_FILLED_TILES_H_

#include "core/base/vec.h"

namespace latvox {

class FilledTiles {
 public:
  virtual ~FilledTiles() = default;

  // Returns whether a cube of 2^level tiles a side that no triangle meets may have points of the set; tile_ijk is its
  // lowest tile, local.
  virtual bool MayHold(const Vec3i& tile_ijk, int level) const = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_FILLED_TILES_H_
