// Which cells of a grid of cubes a triangle concerns.
#ifndef LATVOX_CORE_TILE_CELL_GRID_H_
#define LATVOX_CORE_TILE_CELL_GRID_H_

#include <array>
#include <cstdint>
#include <span>
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

  // What triangles' bounding boxes say of the cells. For each axis, by triangle:
  //   low, high   lowest and highest cell's part in a hit: hits are the parts of all axes, or-ed
  // Above the 16 bits of a hit, `low` has
  //   bit 16      the triangle is long: a cell, or more
  //   bit 17      it comes near to several cells, not all of which need count
  //   bits 18 -   highest - lowest; less than 0 if no cell counts, whatever the other bits
  // and `all` is the or of the three: if nothing is above the hit, it is the one that there is.
  static constexpr size_t kBlock = 128;
  struct Codes {
    std::array<int32_t, kBlock> all;
    std::array<std::array<int32_t, kBlock>, 3> low, high;
  };
  static constexpr int kLongBit = 16, kSeveralBit = 17, kMoreBit = 18;

  // Codes of up to kBlock triangles of the mesh. `vertices` are the mesh's.
  void Encode(const SnappedMesh& mesh, const PaddedVertices& vertices, std::span<const uint32_t> triangles,
              Codes& out) const;

  // Calls f(hit) for each cell that triangle n of the codes comes near to, no more than kMaxFewHits times, and returns
  // true; or returns false if that takes ManyHits, which asks separating axes, not the bounding box alone.
  static constexpr size_t kMaxFewHits = 8;
  template <class F>
  static bool ForEachOfFewHits(const Codes& codes, size_t n, F&& f) {
    const int32_t any = codes.all[n] >> kLongBit;
    if (any == 0) {
      f(static_cast<CellHit>(codes.all[n]));
      return true;
    }
    if (any < 0) return true;
    if (any >= 8 || (any & 3) == 3) return false;  // three cells on an axis, or long and not inside of a cell
    // Which of the axes have two cells is hard to predict: a loop over the subsets of these axes surprises the
    // processor once at most.
    int32_t two = 0;
    for (size_t m = 0; m < 3; ++m) two |= (codes.low[m][n] >> kMoreBit) << (2 - m);
    int32_t subset = 0;
    do {
      int32_t hit = 0;
      for (size_t m = 0; m < 3; ++m) hit |= (subset >> (2 - m) & 1) != 0 ? codes.high[m][n] : codes.low[m][n];
      f(static_cast<CellHit>(hit));
      subset = (subset - two) & two;
    } while (subset != 0);
    return true;
  }

  // The hits of the triangle with these corners.
  std::vector<CellHit> ManyHits(const std::array<Vec3i, 3>& corners) const;

  // What turns the corners of a bounding box into the lowest and highest cell whose margin it meets:
  //   (low - below) >> shift, (high + above) >> shift
  struct Margin {
    Vec3i below, above;
  };
  // What Encode goes by.
  struct Bounds {
    int shift;  // log2 of a cell's side in lattice units
    Margin near, far;
    Vec3i lowest, highest;  // cells that count
  };

 private:
  class LongTriangle;

  Vec3i low_;                       // of the cube, lattice units
  Vec3i near_margin_, far_margin_;  // lattice units
  Bounds bounds_{};
};

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_CELL_GRID_H_
