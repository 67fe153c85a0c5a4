// k-minimality for every mesh: the thesis guarantees it on planes (Theorems 1-7), not where triangles meet
// (section 4.1, figure 4.3). A set of voxels is k-separating iff it is a vertex cover of the crossed edges; a cover can
// be thinned:
//
// For each of the eight parity classes in ascending order, remove every voxel of the class whose crossed edges all have
// their other end in the set. No two voxels of a class are neighbours, so the order within a class does not matter.
// What a pass keeps has a crossed edge with its other end outside, and stays essential since the set only shrinks:
// after eight passes the set is k-minimal, and still covers every edge.
//
// Only voxels that are redundant before the first pass can ever be removed; they are few (below 1 % on smooth
// surfaces). So a few known edges are used first, to show most voxels essential, and all crossed edges are needed of
// the rest only.
#ifndef LATVOX_CORE_THIN_THIN_H_
#define LATVOX_CORE_THIN_THIN_H_

#include <cstdint>
#include <vector>

#include "core/tile/brick.h"
#include "core/tile/tile_box.h"

namespace latvox {

// The ends of a crossed lattice edge, as indices into a TileBox.
struct CrossedEdge {
  uint32_t end, other;
};

// Voxels that nothing yet shows essential.
struct Doubtful {
  TileBox rest;    // those of which all crossed edges can be had
  TileBox unsure;  // those too near to the border of what is known
};

// The members of `set` that none of `edges` shows essential by having its other end outside of the set.
//   edges     some crossed edges; `end` is in the set, and whether `other` is, is known
//   complete  local voxels whose neighbours' membership is known
Doubtful FindDoubtful(const TileBox& set, const std::vector<CrossedEdge>& edges, const IndexBox& complete);

// Thins `set` in place, and returns whether that was decided for all voxels in `wanted`. It always is if what is known
// exceeds `wanted` by kThinHalo steps: a voxel's fate depends on others at most eight steps away.
//   edges   of every voxel in doubtful.rest, as `end`, all crossed edges; or none, if one shows it essential. Any
//   order,
//           duplicates allowed
//   wanted  local voxels
bool Thin(TileBox& set, Doubtful doubtful, std::vector<CrossedEdge> edges, const IndexBox& wanted);
inline constexpr int32_t kThinHalo = kParityClasses;

}  // namespace latvox

#endif  // LATVOX_CORE_THIN_THIN_H_
