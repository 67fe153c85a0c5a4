// Bricks and tiles: the coordinates and units of sparse voxel sets.
//
//   voxel  ijk                lattice coordinates
//   brick  brick_ijk = ijk>>3     8^3 voxels, one bit each
//   tile   tile_ijk  = ijk>>6     8^3 bricks
#ifndef LATVOX_CORE_BRICK_BRICK_H_
#define LATVOX_CORE_BRICK_BRICK_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/brick/label_runs.h"

namespace latvox {

inline constexpr int kBrickBits = 3;  // log2 of a brick's side in voxels
inline constexpr int kTileBits = 6;   // log2 of a tile's side in voxels
inline constexpr int32_t kBrickSide = 1 << kBrickBits;
inline constexpr int32_t kTileSide = 1 << kTileBits;

// 512 voxels in OpenVDB's leaf order: voxel (x, y, z) of the brick is bit (y<<3 | z) of word x.
using BrickMask = std::array<uint64_t, 8>;

struct Brick {
  Vec3i brick_ijk;
  BrickMask mask;  // never empty
};

// The voxels of one tile.
struct TileBricks {
  Vec3i tile_ijk;
  std::vector<Brick> bricks;  // lexicographic order of brick_ijk; never empty
  uint64_t voxels = 0;
  double progress = 0;  // estimated share of the whole work that is done with this tile, 0 to 1
  // For a band, until its fields are found: the square of each voxel's distance, in units (core/band/metric.h), brick
  // by brick, in the masks' order.
  std::vector<double> squares = {};
  // For a labeled set, until its fields are found: the labels of its points.
  LabelRuns labels = {};
  // One for each field of the request, in its order: the values of all voxels, in the same order.
  std::vector<std::vector<std::byte>> fields = {};
};

// A half-open box of lattice points: min <= ijk < max on every axis.
struct IndexBox {
  Vec3i min, max;
  bool operator==(const IndexBox&) const = default;
  bool Contains(const Vec3i& ijk) const {
    for (int m = 0; m < 3; ++m) {
      if (ijk[m] < min[m] || ijk[m] >= max[m]) return false;
    }
    return true;
  }
};

inline bool IsEmpty(const IndexBox& box) {
  return box.min[0] >= box.max[0] || box.min[1] >= box.max[1] || box.min[2] >= box.max[2];
}

// Returns the points of both boxes; there may be none.
inline IndexBox Intersection(IndexBox a, const IndexBox& b) {
  for (size_t m = 0; m < 3; ++m) {
    a.min[m] = std::max(a.min[m], b.min[m]);
    a.max[m] = std::min(a.max[m], b.max[m]);
  }
  return a;
}

inline uint64_t CountVoxels(const BrickMask& mask) {
  uint64_t count = 0;
  for (uint64_t word : mask) count += static_cast<uint64_t>(std::popcount(word));
  return count;
}

// Clears the voxels of a brick that lie outside of the box. By masks, because flat ground has most of its bricks on the
// border of its box.
inline void ClipBrick(const IndexBox& box, Brick& brick) {
  int begin[3], end[3], inside = 1;
  for (size_t m = 0; m < 3; ++m) {
    const int64_t low = int64_t{brick.brick_ijk[m]} * kBrickSide;
    begin[m] = static_cast<int>(std::clamp<int64_t>(box.min[m] - low, 0, kBrickSide));
    end[m] = static_cast<int>(std::clamp<int64_t>(box.max[m] - low, begin[m], kBrickSide));
    inside &= end[m] - begin[m] == kBrickSide;
  }
  if (inside) return;
  const auto below = [](int n) { return n == 64 ? ~uint64_t{0} : (uint64_t{1} << n) - 1; };
  const uint64_t row = (below(end[2]) & ~below(begin[2])) * 0x0101010101010101;
  const uint64_t plane = row & below(end[1] * kBrickSide) & ~below(begin[1] * kBrickSide);
  for (int i = 0; i < kBrickSide; ++i) brick.mask[static_cast<size_t>(i)] &= begin[0] <= i && i < end[0] ? plane : 0;
}

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_BRICK_H_
