// Finds the lattice links that tiny triangles cross, for a whole mesh.
//
// Where triangles are smaller than voxels, few lines lie between their corners at all. One pass over the mesh finds the
// crossings of all directions. The crossings, not the triangles, are then sorted into tiles. There are no candidates
// and no stars.
#ifndef LATVOX_CORE_TINY_TINY_H_
#define LATVOX_CORE_TINY_TINY_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/tile/tile_links.h"
#include "core/triangles/corner_list.h"

namespace latvox {

// Used by one thread for its part of the mesh.
class TinyCrossings {
 public:
  //   box    local voxels; links with a nearer end outside are not wanted
  //   links  has the results once this object is destroyed, which must be before links.Finish()
  TinyCrossings(const std::vector<ScanFrame>& frames, const IndexBox& box, TileLinks& links);
  ~TinyCrossings();

  // The origin (core/triangles/corner_list.h) that lists of triangles must have.
  static Vec3i Origin(const TileLinks& links) { return links.first_tile() * kTileSide; }

  // Finds all links, in all directions, that the tiny triangles cross. Other triangles go to `kept`, as in Sift.
  void Find(const CornerList& triangles, std::vector<uint32_t>& kept, uint8_t* is_tiny);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_TINY_H_
