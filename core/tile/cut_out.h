// Converts dense bits to bricks.
#ifndef LATVOX_CORE_TILE_CUT_OUT_H_
#define LATVOX_CORE_TILE_CUT_OUT_H_

#include "core/brick/brick.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// The members of `bits` within the tile at `tile_min` and within `region` (both local), as bricks in lexicographic
// order. brick_ijk, tile_ijk: moved by base_ijk, a multiple of kTileSide.
TileBricks CutOut(const BitsLayout& layout, const TileBits& bits, const Vec3i& tile_min, const IndexBox& region,
                  const Vec3i& base_ijk);

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_CUT_OUT_H_
