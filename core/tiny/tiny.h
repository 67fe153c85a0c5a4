// The lattice edges that tiny triangles cross, of a whole mesh.
//
// Where triangles are smaller than voxels, few lines lie between their corners at all: the crossings of all directions
// are found in one pass over the mesh, and these, not the triangles, are sorted into tiles. No candidates, no stars.
#ifndef LATVOX_CORE_TINY_TINY_H_
#define LATVOX_CORE_TINY_TINY_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/tile/tile_links.h"
#include "core/triangles/corner_list.h"

namespace latvox {

// For one thread to go through a mesh with.
class TinyCrossings {
 public:
  //   box    local voxels: of edges with a nearer end outside, nothing is wanted
  //   edges  has what is found once this is destroyed, which must be before edges.Finish()
  TinyCrossings(const std::vector<ScanFrame>& frames, const IndexBox& box, TileLinks& edges);
  ~TinyCrossings();

  // The origin (core/triangles/corner_list.h) that lists of triangles must have.
  static Vec3i Origin(const TileLinks& edges) { return edges.first_tile() * kTileSide; }

  // Finds all edges, in all directions, that the tiny ones of the triangles cross. Others go to `kept`, as Sift says.
  void Find(const CornerList& triangles, std::vector<uint32_t>& kept, uint8_t* is_tiny);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_TINY_H_
