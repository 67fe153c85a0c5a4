// The pieces of the free points in and around one tile, and what they share with the tiles around.
//
// A tile is looked at with a halo of one step. Two tiles that share a face have a slab of points in common, two halos
// thick. A patch is a connected part of the free points of the slab. Both tiles find the same patches in the same
// order, because they see the same walls there. Each patch lies in one piece of either tile, so it unites the two.
//
// That finds all connections. A step between two points lies in the box of some tile, because the halo is as wide as
// the longest step. And two tiles that share only an edge or a corner are joined by tiles that share faces with both.
#ifndef LATVOX_CORE_WALK_TILE_PIECES_H_
#define LATVOX_CORE_WALK_TILE_PIECES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/walk/row_pieces.h"
#include "core/walk/steps.h"
#include "core/walk/tile_rows.h"

namespace latvox {

// A tile's pieces, by their numbers. It is compact, because a job keeps one for each tile near the mesh.
class TilePieces {
 public:
  uint32_t count() const { return (static_cast<uint32_t>(numbers_.size()) - patches_ends_.back()) / 2; }

  // The piece of each patch that the tile shares with its neighbor along an axis, on the side of lower coordinates
  // (0) or of higher ones (1).
  std::span<const uint32_t> Patches(size_t axis, size_t side) const {
    const size_t face = 2 * axis + side, begin = face == 0 ? 0 : patches_ends_[face - 1];
    return {numbers_.data() + begin, patches_ends_[face] - begin};
  }
  // The number of a piece's points in the tile itself.
  uint32_t PointsOf(uint32_t piece) const { return numbers_[patches_ends_.back() + 2 * piece]; }
  // Whether a piece has points outside of the mesh's box.
  bool IsOutside(uint32_t piece) const { return numbers_[patches_ends_.back() + 2 * piece + 1] != 0; }

 private:
  friend class PieceScan;
  std::vector<uint32_t> numbers_;  // patches face by face; then points and whether it is outside, piece by piece
  std::array<uint32_t, 6> patches_ends_{};
};

// Each thread has its own.
class PieceScan {
 public:
  // Finds the pieces of a tile.
  //   steps      must outlive the results
  //   box        of the tile; its halo is steps.reach
  //   walls      rows of the box: points that the walk may not enter
  //   mesh_box   local; the points outside are connected
  TilePieces Find(const WalkSteps& steps, const HaloBox& box, std::span<const WideRow> walls, const IndexBox& mesh_box);

  // The pieces of the last tile, or after FindOnly.
  const RowPieces& pieces() const { return pieces_; }
  void FindOnly(const WalkSteps& steps, const HaloBox& box, std::span<const WideRow> walls);

  size_t Bytes() const { return BytesOf(free_) + BytesOf(slab_) + pieces_.Bytes() + patches_.Bytes(); }

 private:
  void CountPoints(const HaloBox& box, const IndexBox& mesh_box, std::span<uint32_t> numbers) const;
  void AddPatches(const WalkSteps& steps, const HaloBox& box, size_t axis, size_t side, std::vector<uint32_t>& numbers);

  std::vector<WideRow> free_, slab_;
  RowPieces pieces_, patches_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_TILE_PIECES_H_
