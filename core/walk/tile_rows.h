// The rows of a tile with its halo: the points from which a step may lead into the tile, or over its border.
#ifndef LATVOX_CORE_WALK_TILE_ROWS_H_
#define LATVOX_CORE_WALK_TILE_ROWS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/block/block_box.h"
#include "core/brick/brick.h"
#include "core/tile/tile_bits.h"
#include "core/walk/row_pieces.h"

namespace latvox {

// The points of a tile: bit k of row i << 6 | j.
using TileRows = std::array<uint64_t, size_t{kTileSide} * kTileSide>;

// The box of a tile and its halo. Its rows lie along k, those of one plane along i after the other.
struct HaloBox {
  Vec3i halo;  // voxels on every side, per axis
  Vec3i low;   // local
  Vec3i side;

  //   tile_ijk   local
  HaloBox(const Vec3i& tile_ijk, const Vec3i& around)
      : halo(around),
        low(tile_ijk * kTileSide - around),
        side(around + around + Vec3i{kTileSide, kTileSide, kTileSide}) {}

  size_t rows() const { return static_cast<size_t>(side[0]) * static_cast<size_t>(side[1]); }
  size_t RowOf(int32_t i, int32_t j) const {
    return static_cast<size_t>(i) * static_cast<size_t>(side[1]) + static_cast<size_t>(j);
  }
  // The row of the tile itself with that number, i << 6 | j.
  size_t RowOfTile(size_t row) const {
    return RowOf(static_cast<int32_t>(row >> kTileBits) + halo[0],
                 static_cast<int32_t>(row & (kTileSide - 1)) + halo[1]);
  }
};

// Reads the points of a set in the box. Precondition: `layout` has the box, and a plane more on every side.
void ReadRows(const BitsLayout& layout, const TileBits& bits, const HaloBox& box, std::vector<WideRow>& rows);

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_TILE_ROWS_H_
