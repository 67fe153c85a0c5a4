// Bricks and tiles, made and compared.
#ifndef LATVOX_TESTS_UNIT_BOTH_ENDS_BRICKS_H_
#define LATVOX_TESTS_UNIT_BOTH_ENDS_BRICKS_H_

#include <gtest/gtest.h>

#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "latvox/for_each_voxel.h"

namespace latvox {

inline bool Has(const BrickMask& mask, int x, int y, int z) { return mask[x] >> (8 * y + z) & 1; }

inline BrickMask With(int x, int y, int z, BrickMask mask = {}) {
  mask[x] |= uint64_t{1} << (8 * y + z);
  return mask;
}

// Returns a tile with bricks at the places `which`, all with this mask.
inline TileBricks TileWith(const Vec3i& tile_ijk, const BrickMask& which, const BrickMask& mask) {
  TileBricks tile{tile_ijk, {}};
  for (int n = 0; n < 512; ++n) {
    const Vec3i place{n >> 6, n >> 3 & 7, n & 7};
    if (Has(which, place[0], place[1], place[2])) tile.bricks.push_back({tile_ijk * 8 + place, mask});
  }
  return tile;
}

inline void ExpectSame(const std::vector<client::Brick>& bricks, const std::vector<TileBricks>& tiles) {
  size_t n = 0;
  for (const TileBricks& tile : tiles) {
    for (const Brick& brick : tile.bricks) {
      ASSERT_LT(n, bricks.size());
      ASSERT_EQ(bricks[n].brick_ijk, brick.brick_ijk);
      ASSERT_EQ(bricks[n].mask, brick.mask);
      ++n;
    }
  }
  ASSERT_EQ(n, bricks.size());
}

// Returns a tile like the first one of a request: a curved surface through at most 512 bricks.
inline TileBricks CurvedTile() {
  TileBricks tile{{3, -7, 11}, {}};
  for (int n = 0; n < 512; ++n) {
    Brick brick{tile.tile_ijk * 8 + Vec3i{n >> 6, n >> 3 & 7, n & 7}, {}};
    for (int v = 0; v < 512; ++v) {
      const int x = (n >> 6) * 8 + (v >> 6), y = (n >> 3 & 7) * 8 + (v >> 3 & 7), z = (n & 7) * 8 + (v & 7);
      const int distance = x * x + y * y + z * z - 60 * 60;
      if (distance >= 0 && distance < 120) brick.mask = With(v >> 6, v >> 3 & 7, v & 7, brick.mask);
    }
    if (CountVoxels(brick.mask) != 0) tile.bricks.push_back(brick);
  }
  return tile;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_BOTH_ENDS_BRICKS_H_
