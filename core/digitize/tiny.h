// The lattice edges that tiny triangles cross, of a whole mesh.
//
// Where triangles are smaller than voxels, few lines lie between their corners at all: the crossings of all directions
// are found in one pass over the mesh, and these, not the triangles, are sorted into tiles. No candidates, no stars.
#ifndef LATVOX_CORE_DIGITIZE_TINY_H_
#define LATVOX_CORE_DIGITIZE_TINY_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/uninitialized.h"
#include "core/digitize/fineness.h"
#include "core/digitize/principal_scan.h"
#include "core/digitize/sift.h"
#include "core/snap/corner_list.h"
#include "core/snap/surface_facts.h"
#include "core/tile/tile_edges.h"

namespace latvox {

// For a thread to go through a mesh with.
class TinyCrossings {
 public:
  //   box    local voxels: of edges with a nearer end outside, nothing is wanted
  //   edges  gets what is found once this is destroyed
  TinyCrossings(const std::vector<ScanFrame>& frames, const IndexBox& box, TileEdges& edges);
  ~TinyCrossings();

  // Finds all edges, in all directions, that the tiny ones of the triangles cross. Others go to `kept`, as Sift says.
  void Find(const CornerList& triangles, std::vector<uint32_t>& kept, uint8_t* is_tiny);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

// What one pass over a fine mesh tells.
struct FineTriangles {
  std::vector<uint32_t> kept;  // those left to be digitized one by one, ascending
  SurfaceFacts facts;
};

// Goes through the mesh with all threads of the arena. By `fineness`, left to be digitized are all triangles but those
// that no lattice line can meet (core/digitize/touching.h), all but tiny ones, whose edges go to `edges`, or all.
//   is_tiny   if not null and most are tiny, sized and set for all triangles: 0 for those to be digitized one by one;
//             then tiny ones that lines may meet are kept, too, as Sift says
// Once the job is cancelled, parts are missing.
FineTriangles SortOutFine(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const Fineness& fineness,
                          const IndexBox& box, const std::atomic<bool>& cancelled, TileEdges& edges,
                          UninitializedVector<uint8_t>* is_tiny);

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_TINY_H_
