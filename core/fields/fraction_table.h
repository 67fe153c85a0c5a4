// The fractions of a tile's voxels, while tiles of the finer lattice come in any order.
#ifndef LATVOX_CORE_FIELDS_FRACTION_TABLE_H_
#define LATVOX_CORE_FIELDS_FRACTION_TABLE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/lattice/cell_points.h"

namespace latvox {

// A fraction is the number of a cell's points that are inside. At first, each cell counts as if it were on the side of
// its voxel. Then each finer tile near the mesh adds the points that are on the other side. Cubes of voxels on one
// side are compared with whole rows of a finer tile, so a cube without the mesh costs little. Each thread has its own
// table, and reuses it from tile to tile.
class FractionTable {
 public:
  // The numbers of voxels in a field with `count` numbers for each of them: the n-th number of each.
  struct Column {
    std::vector<std::byte>& field;
    size_t n = 0, count = 1;
  };

  // Begins with a tile, and sets its fractions.
  //   cell      must live while this is used, as must `inside` and the tile, unchanged
  //   first     the finer point of the tile's lowest voxel
  //   inside    bit k of row (i << 6 | j): whether that voxel of the tile is inside
  //   out       in the tile's field, which gets its size with its first column, and is empty before
  void Begin(const CellPoints& cell, const Vec3i& first, std::span<const uint64_t> inside, const TileBricks& tile,
             const Column& out);

  // The box of all points of all cells that the tile may have.
  IndexBox Around() const;

  // Returns whether voxels of the tile may have points in a cube of 2^level finer tiles a side with this lowest point.
  bool Meets(const Vec3i& low, int level) const;

  // Counts the points of a finer tile with this lowest point. Each finer tile may come once.
  //   rows   like `inside`
  void Add(const Vec3i& low, std::span<const uint64_t> rows);

  size_t Bytes() const { return BytesOf(bricks_) + BytesOf(runs_); }

 private:
  enum class Side { kOutside, kInside, kBoth };
  struct PlacedBrick {
    const BrickMask* mask;
    Vec3i at;        // its lowest voxel, in the tile
    uint32_t first;  // the number of its first voxel
    Side side;       // of all its voxels
  };
  // As CellPoints::Run.
  struct Run {
    Vec3i at;
    int32_t row;  // i << 6 | j, for points of one finer tile
    uint64_t mask;
  };
  // The tile's voxels, both ends included, that may have points in some box.
  struct Range {
    Vec3i first, last;
  };

  // Some voxels of a brick.
  struct Cube {
    Vec3i at;  // the lowest, in the tile
    int32_t side;
  };
  struct FinerTile {
    Vec3i base;  // the finer point of the tile's lowest voxel, in the finer tile
    Range near;  // voxels that may have points in it
    std::span<const uint64_t> rows;
  };

  Range VoxelsNear(const Vec3i& low, int level) const;
  template <class F>
  bool AnyBrick(const Range& range, const F& f) const;
  Side SetBrick(const Brick& brick, const Vec3i& at, uint32_t first);
  Side SideOf(const Cube& cube) const;
  bool IsSettled(const Cube& cube, Side side, const FinerTile& finer) const;
  void AddBrick(const PlacedBrick& brick, const FinerTile& finer);
  void AddCube(const PlacedBrick& brick, const Cube& cube, const FinerTile& finer);
  void AddVoxel(const Vec3i& z, const FinerTile& finer, uint16_t& value) const;
  uint32_t CountWhole(const Vec3i& at, std::span<const uint64_t> rows, uint64_t flip) const;
  uint32_t CountPart(const Vec3i& at, std::span<const uint64_t> rows, uint64_t flip) const;

  const CellPoints* cell_ = nullptr;
  Vec3i first_{};
  std::span<const uint64_t> inside_;
  uint16_t* values_ = nullptr;           // of the first voxel
  size_t stride_ = 1;                    // from voxel to voxel
  std::array<uint16_t, 512> numbers_{};  // in bricks_, plus 1, of each brick of the tile; 0: it has none
  std::vector<PlacedBrick> bricks_;
  std::vector<Run> runs_;
  std::array<uint16_t, 512> ranks_{};  // of a brick's voxels; others are meaningless
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_FRACTION_TABLE_H_
