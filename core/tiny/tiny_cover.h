// Finds the cells that tiny triangles meet, for a whole mesh: the supercover where cells are boxes along the lattice
// axes.
//
// Most tiny triangles lie in a box of cells with one or two of them along each axis. The box tells which cells a
// triangle meets, or a few signs do. So one pass over the mesh finds these cells in lanes. The cells, not the
// triangles, are then sorted into tiles, as are the links of tiny triangles for other sets (core/tiny/tiny.h).
#ifndef LATVOX_CORE_TINY_TINY_COVER_H_
#define LATVOX_CORE_TINY_TINY_COVER_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/tile/tile_links.h"
#include "core/triangles/corner_list.h"

namespace latvox {

// A triangle is tiny here if it is near (core/triangles/corner_list.h), and if its box of cells has at most two of them
// along each axis.
inline constexpr int kMostCells = 2;

// Used by one thread for its part of the mesh. The scalar kernel finds no cells: see CanFindTiny.
class TinyCover {
 public:
  //   box    local voxels; others are not wanted
  //   links  has the results once this object is destroyed, which must be before links.Finish(): each voxel as the
  //          nearer end of a link of direction 0. Its origin for lists is TinyCrossings::Origin
  TinyCover(const IndexBox& box, TileLinks& links);
  ~TinyCover();

  // Finds all voxels whose closed cells meet the tiny triangles. Appends the numbers of other triangles to `kept`, in
  // their order.
  void Find(const CornerList& triangles, std::vector<uint32_t>& kept);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_TINY_COVER_H_
