// Which cells of a grid of cubes a triangle concerns.
#ifndef LATVOX_CORE_TILE_CELL_GRID_H_
#define LATVOX_CORE_TILE_CELL_GRID_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/snap/padded_vertices.h"
#include "core/snap/snap.h"
#include "core/tile/brick.h"

namespace latvox {

inline constexpr int kMaxGridLevels = 4;

// A cell that a triangle comes near to: (number << 1 | fringe). Cells are numbered in Morton order, i most significant.
// Fringe says that the triangle comes within the far margin of the cell, not within the near one.
using CellHit = uint16_t;

// A cube of tiles, cut into 2^levels cells a side. Cells that do not meet a region do not count.
class CellGrid {
 public:
  //   tile_ijk, level   the cube: its lowest tile, local, and the log2 of its side in tiles
  //   near, far         margins, voxels per axis, near <= far
  //   region            local voxels
  // Precondition: levels <= level, levels <= kMaxGridLevels.
  CellGrid(const Vec3i& tile_ijk, int level, int levels, const Vec3i& near, const Vec3i& far, const IndexBox& region);

  // Whether no cell counts.
  bool IsEmpty() const;

  // What a triangle's bounding box says of the cells. For each axis, and a fourth time without a meaning:
  //   low, high   lowest and highest cell's part in a hit: hits are the parts of all axes, or-ed
  // Above the 16 bits of a hit, `low` has
  //   bit 16      the triangle is long: a cell, or more
  //   bit 17      it comes near to several cells, not all of which need count
  //   bits 18 -   highest - lowest; less than 0 if no cell counts, whatever the other bits
  struct Code {
    std::array<int32_t, 4> low, high;
  };
  static constexpr int kLongBit = 16, kSeveralBit = 17, kMoreBit = 18;

  // Codes of `count` triangles: triangles[ids[0]], triangles[ids[1]], ..., or triangles[0], triangles[1], ... if ids is
  // null.
  void Encode(const PaddedVertices& vertices, const std::array<uint32_t, 3>* triangles, const uint32_t* ids,
              size_t count, Code* out) const;

  // Calls f(hit) for each cell that a triangle comes near to, no more than kMaxFewHits times, and returns true; or
  // returns false if that takes ManyHits, which asks separating axes, not the bounding box alone.
  static constexpr size_t kMaxFewHits = 8;
  template <class F>
  static bool ForEachOfFewHits(const Code& code, F&& f) {
    const int32_t any = (code.low[0] | code.low[1] | code.low[2]) >> kLongBit;
    if (any < 0) return true;
    if (any >= 8 || (any & 3) == 3) return false;  // three cells on an axis, or long and not inside of a cell
    // Which of the axes have two cells is hard to predict: a loop over the subsets of these axes surprises the
    // processor once at most.
    const int32_t two = (code.low[0] >> kMoreBit) << 2 | (code.low[1] >> kMoreBit) << 1 | code.low[2] >> kMoreBit;
    int32_t subset = 0;
    do {
      const int32_t i = (subset & 4) != 0 ? code.high[0] : code.low[0];
      const int32_t j = (subset & 2) != 0 ? code.high[1] : code.low[1];
      const int32_t k = (subset & 1) != 0 ? code.high[2] : code.low[2];
      f(static_cast<CellHit>(i | j | k));
      subset = (subset - two) & two;
    } while (subset != 0);
    return true;
  }

  // The hits of the triangle with these corners.
  std::vector<CellHit> ManyHits(const std::array<Vec3i, 3>& corners) const;

  // What turns the corners of a bounding box into the lowest and highest cell whose margin it meets:
  //   (low - below) >> shift, (high + above) >> shift
  struct Margin {
    std::array<int32_t, 4> below, above;
  };
  // What Encode goes by.
  struct Bounds {
    int shift;  // log2 of a cell's side in lattice units
    Margin near, far;
    std::array<int32_t, 4> lowest, highest;  // cells that count
  };

 private:
  class LongTriangle;

  Vec3i low_;                       // of the cube, lattice units
  Vec3i near_margin_, far_margin_;  // lattice units
  Bounds bounds_{};
};

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_CELL_GRID_H_
